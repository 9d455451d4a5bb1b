// The list of what was found to be damaged: each finding with its details, its curve, whether it is
// accepted, and the command line that writes what the page shows of it.
import { centimetres } from "motion-data";
import { strokeCurves } from "motion-timeline";

const AXES = ["x", "height", "z"];
const WIDTH = 224, HEIGHT = 56; // of a curve, pixels

// The command that writes the repair of these findings, by their numbers, into a file of its own.
export function onlyCommand(command, numbers, name) {
  return `${command.replace(/_finding_0(?=\.\w+)/, `_${name}`)} --only ${numbers.join(" ")}`;
}

// The command that also repairs what was only proposed, as if the user had found it.
function proposedCommand(command, { joint, frames }) {
  const named = joint === "body" ? "" : ` --joint ${joint}`;
  return `${command.replace(/_finding_0(?=\.\w+)/, "_proposal")}${named} --frames ${frames.join(" ")}`;
}

const framesOf = ([first, last]) => (last > first ? `frames ${first} to ${last}` : `frame ${first}`);
const isProposed = ({ status }) => Boolean(status) && status !== "repaired";

// The place of a joint along the axis on which two motions differ most in these frames, from the hips, in
// metres; of the hips in the world.
function curvesOf(motions, { joint, frames: [first, last] }, from, to) {
  const at = Math.max(motions[0].names.indexOf(joint), 0);
  const place = ({ positions, joints }, frame, axis) =>
    positions[3 * (frame * joints + at) + axis] - (at ? positions[3 * frame * joints + axis] : 0);
  const pair = motions.slice(0, 2).filter(({ names }) => names.includes(motions[0].names[at]));
  const apart = [0, 1, 2].map((axis) => {
    let most = 0;
    for (let frame = first; frame <= last; frame++) most = Math.max(most, Math.abs(place(pair.at(-1), frame, axis) - place(pair[0], frame, axis)));
    return most;
  });
  const axis = apart.indexOf(Math.max(...apart));
  const curves = pair.map((motion) => ({
    colour: motion.colour, values: Float32Array.from({ length: to - from + 1 }, (_, i) => place(motion, from + i, axis)),
  }));
  return { curves, name: `${AXES[axis]} of ${motions[0].names[at].replaceAll("_", " ")}${at ? " from the hips" : ""}` };
}

export class FindingsPanel {
  constructor(box, element, { findings, command, motions, frames, rate }, onChosen) {
    Object.assign(this, { element, command, motions, frames, rate, onChosen, accepted: new Set() });
    const proposed = findings.filter(isProposed), found = findings.filter((finding) => !isProposed(finding));
    this.found = found;
    this.rows = [];
    this.section(box, found, found.length === 1 ? "1 finding" : `${found.length} findings`);
    this.section(box, proposed, proposed.length === 1 ? "1 proposal, not changed" : `${proposed.length} proposals, not changed`);
    if (!command || found.length < 2) return;
    this.all = element(box, "div", { className: "detail", hidden: true });
    element(this.all, "p", { textContent: "The accepted findings alone are repaired by" });
    this.code = this.commandLine(this.all, "");
  }

  section(box, findings, title) {
    if (!findings.length && title[0] === "0" && this.rows.length + this.found.length) return;
    this.element(box, "h2", { textContent: title });
    const list = this.element(box, "ol");
    findings.forEach((finding, at) => this.row(list, finding, at + 1));
  }

  row(list, finding, number) {
    const { joint, frames, kind, cm } = finding, item = this.element(list, "li");
    const button = this.element(item, "button", { type: "button", ariaExpanded: "false" });
    this.element(button, "b", { textContent: `${number}. ${joint.replaceAll("_", " ")}` });
    this.element(button, "span", { textContent: [framesOf(frames), kind, cm ? centimetres(cm) : ""].filter(Boolean).join(" \u00b7 ") });
    const detail = this.element(item, "div", { className: "detail", hidden: true });
    const row = { finding, number, button, detail };
    button.addEventListener("click", () => {
      this.choose(row);
      button.scrollIntoView?.({ block: "nearest" });
    });
    this.rows.push(row);
    if (!isProposed(finding)) this.accepted.add(number);
  }

  // Show the details of a finding below its line, and nothing of the others.
  choose(row) {
    for (const each of this.rows) {
      each.detail.hidden = each !== row;
      each.button.ariaExpanded = String(each === row);
      each.button.setAttribute("aria-pressed", each === row);
    }
    if (!row.detail.childElementCount) this.fill(row);
    this.onChosen(row.finding);
  }

  fill({ finding, number, detail }) {
    const { evidence, confidence } = finding;
    const sure = confidence === undefined ? "" : `Confidence ${Math.round(100 * confidence)}%.`;
    this.element(detail, "p", { textContent: [evidence && `${evidence[0].toUpperCase()}${evidence.slice(1)}.`, sure].filter(Boolean).join(" ") });
    this.curve(detail, finding);
    if (!this.command) return;
    if (isProposed(finding)) {
      this.element(detail, "p", { textContent: "To repair it too:" });
      this.commandLine(detail, proposedCommand(this.command, finding));
      return;
    }
    if (this.all) {
      const label = this.element(detail, "label");
      const box = this.element(label, "input", { type: "checkbox", checked: this.accepted.has(number) });
      label.append("accept");
      box.addEventListener("change", () => this.accept(number, box.checked));
    }
    this.element(detail, "p", { textContent: "This finding alone, as the page shows it:" });
    this.commandLine(detail, onlyCommand(this.command, [number], `finding_${number}`));
  }

  accept(number, accepted) {
    this.accepted[accepted ? "add" : "delete"](number);
    this.rows.forEach((row) => row.button.classList.toggle("rejected", !isProposed(row.finding) && !this.accepted.has(row.number)));
    const numbers = [...this.accepted].sort((a, b) => a - b);
    this.all.hidden = !numbers.length || numbers.length === this.found.length;
    this.code.textContent = onlyCommand(this.command, numbers, "accepted");
  }

  curve(detail, finding) {
    const [first, last] = finding.frames, around = Math.round(this.rate / 2);
    const from = Math.max(first - around, 0), to = Math.min(last + around, this.frames - 1);
    const { curves, name } = curvesOf(this.motions, finding, from, to);
    const canvas = this.element(detail, "canvas", { width: 2 * WIDTH, height: 2 * HEIGHT, role: "img" });
    const pen = canvas.getContext("2d");
    pen.scale(2, 2);
    const across = (frame) => (frame - from) / Math.max(to - from, 1) * WIDTH;
    pen.fillStyle = "rgba(128, 140, 152, .25)";
    pen.fillRect(across(first), 0, Math.max(across(last) - across(first), 1), HEIGHT);
    const [low, high] = strokeCurves(pen, curves, 0, WIDTH, HEIGHT);
    const text = `${name}, ${low.toFixed(2)} to ${high.toFixed(2)} m, frames ${from} to ${to}: before orange, after blue`;
    canvas.ariaLabel = text;
    this.element(detail, "p", { className: "caption", textContent: text });
  }

  commandLine(parent, text) {
    const code = this.element(parent, "code", { tabIndex: 0, textContent: text });
    const copy = this.element(parent, "button", { type: "button", textContent: "copy" });
    copy.addEventListener("click", async () => {
      try {
        await navigator.clipboard.writeText(code.textContent);
        copy.textContent = "copied";
      } catch {
        getSelection().selectAllChildren(code);
        copy.textContent = "selected: press Ctrl C";
      }
      setTimeout(() => { copy.textContent = "copy"; }, 2000);
    });
    return code;
  }
}
