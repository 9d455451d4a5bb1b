// Weights of the search: guides first, then commands and functions, lessons and the lab book last.
const WEIGHTS = [
  [/^(install|repair|from_your_program|verify|course|reproduce_the_paper|features|own_operation)$/, 4],
  [/^(index|results|map|glossary|starter_model)$/, 2],
  [/^reference\/commands$/, 2],
  [/^lessons\//, 0.5],
  [/^lab_book\//, 0.25],
  [/^evidence$/, 0.25],
];

var Scorer = {
  score: ([docName, title, anchor, descr, score]) => {
    const found = WEIGHTS.find(([pattern]) => pattern.test(docName));
    return score * (found ? found[1] : 1);
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
