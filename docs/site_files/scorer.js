// Weights of the search: guides first, then functions and commands, lessons and the lab book last.
const WEIGHTS = [
  [/^(install|repair|edit|from_your_program|verify|course|own_operation|layers_of_other_forms)$/, 3],
  [/^reference\/numpy_cae\.fast\./, 0.5],
  [/^reference\/numpy_cae\./, 2],
  [/^reference\/commands$/, 1.5],
  [/^lessons\//, 0.5],
  [/^(wrong_gradients|maintaining|lab_book\/.*)$/, 0.25],
];

var Scorer = {
  score: ([docName, title, anchor, descr, score]) => {
    const weight = WEIGHTS.find(([pattern]) => pattern.test(docName));
    return score * (weight ? weight[1] : 1);
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
