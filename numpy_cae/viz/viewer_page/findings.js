// The list of what was found to be damaged, and the command line that repairs one of the findings.

const dot = "\u00b7";

// Joints that are damaged in the same way in the same frames are one entry, with the evidence and the
// confidence of the joint that moves farthest.
export function grouped(findings) {
  const groups = new Map();
  for (const finding of findings) {
    const key = JSON.stringify([finding.frames, finding.kind]);
    const group = groups.get(key) ?? { joints: [], cm: -1 };
    group.joints.push(finding.joint);
    groups.set(key, (finding.cm ?? 0) > group.cm ? { ...group, ...finding, cm: finding.cm ?? 0 } : group);
  }
  return [...groups.values()].sort((one, other) => one.frames[0] - other.frames[0]);
}

// The options that repair just this finding.
export function repairCommand(command, { joints, frames: [first, last] }) {
  const named = joints.filter((joint) => joint && joint !== "body");
  return [command, named.length ? `--joint ${named.join(" ")}` : "", `--frames ${first} ${last}`].filter(Boolean).join(" ");
}

function described({ joints, frames: [first, last], kind, evidence, cm, confidence }) {
  const named = joints.length > 4 ? `${joints.slice(0, 3).join(", ")} and ${joints.length - 3} more` : joints.join(", ");
  return {
    title: named.replaceAll("_", " ") || "all joints",
    details: [
      last > first ? `frames ${first} to ${last}` : `frame ${first}`, kind, evidence,
      cm ? `${cm.toPrecision(2)} cm` : "",
      confidence === undefined || confidence === null ? "" : `confidence ${Math.round(100 * confidence)}%`,
    ].filter(Boolean).join(` ${dot} `),
  };
}

export class FindingsPanel {
  constructor(box, element, { findings, command, source }, onChosen) {
    const groups = grouped(findings);
    element(box, "h2", { textContent: source || "Findings" });
    element(box, "p", { textContent: groups.length === 1 ? "1 finding" : `${groups.length} findings` });
    const list = element(box, "ol");
    this.buttons = groups.map((group) => {
      const button = element(element(list, "li"), "button", { type: "button" });
      const { title, details } = described(group);
      element(button, "b", { textContent: title });
      element(button, "span", { textContent: details });
      button.addEventListener("click", () => this.choose(group, button, onChosen));
      return button;
    });
    if (!command) return;
    this.command = command;
    const line = element(box, "div", { className: "command", hidden: true });
    element(line, "p", { textContent: "This finding alone is repaired by" });
    this.code = element(line, "code", { tabIndex: 0 });
    const copy = element(line, "button", { type: "button", textContent: "copy" });
    copy.addEventListener("click", () => navigator.clipboard?.writeText(this.code.textContent));
    this.line = line;
  }

  choose(group, button, onChosen) {
    this.buttons.forEach((each) => each.setAttribute("aria-pressed", each === button));
    if (this.line) {
      this.line.hidden = false;
      this.code.textContent = repairCommand(this.command, group);
    }
    onChosen(group);
  }
}
