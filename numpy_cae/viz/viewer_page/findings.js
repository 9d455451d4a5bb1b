// The list of what was found to be damaged, by events; beside it the details of the chosen finding: its
// curve, whether its repair is kept, and the command line that writes what the page shows of it.
import { centimetres, distance, placeOf } from "motion-data";
import { TINT, strokeCurves } from "motion-timeline";

const AXES = ["x", "height", "z"];
const WIDTH = 224, HEIGHT = 56; // of a curve, pixels
const PHONE = matchMedia("(max-width: 44rem)");
const SECTIONS = [
  ["repaired", (count) => (count === 1 ? "1 finding" : `${count} findings`)],
  ["proposed", (count) => (count === 1 ? "1 proposal, not changed" : `${count} proposals, not changed`)],
  ["left", (count) => `${count} found, left alone`],
  ["kept", (count) => `${count} kept as it is`],
]; // by status, each with its heading

// The command that writes the repair of these findings, by their numbers, into a file of its own.
export function onlyCommand(command, numbers, name) {
  return `${command.replace(/_finding_0(?=\.\w+)/, `_${name}`)} --only ${numbers.join(" ")}`;
}

const statusOf = ({ status }) => status || "repaired";
const spaced = (name) => name.replaceAll("_", " ");
const framesOf = ([first, last]) => (last > first ? `frames ${first} to ${last}` : `frame ${first}`);

// The joint of a finding or one below it that two motions place furthest apart in its frames, and the axis
// on which they do. Of a long finding some of the frames are compared.
function movedMost([before, after = before], { joint, frames: [first, last], mover }) {
  const { names, parents } = before, top = names.indexOf(mover || joint);
  const isBelow = (at) => (mover ? at === top : at === top || top < 0 || (parents[at] >= 0 && isBelow(parents[at])));
  const most = { at: Math.max(top, 0), axis: 1, metres: 0 };
  if (names.join() !== after.names.join()) return most;
  for (const at of names.keys()) {
    for (let frame = first; isBelow(at) && frame <= last; frame += Math.ceil((last - first + 1) / 300)) {
      const metres = distance(after, before, frame, at);
      if (metres <= most.metres) continue;
      const apart = [0, 1, 2].map((axis) => Math.abs(placeOf(after, frame, at, axis) - placeOf(before, frame, at, axis)));
      Object.assign(most, { at, metres, axis: apart.indexOf(Math.max(...apart)) });
    }
  }
  return most;
}

// "the left wrist moves 87 cm"; the joint is left out where it is the finding's.
function movement({ cm }, mover, place) {
  if (!cm) return "";
  return `${mover === place ? "" : `the ${spaced(mover)} `}moves ${centimetres(cm)}`;
}

export class FindingsPanel {
  constructor(box, element, { findings, command, motions, frames, rate }, onChosen) {
    Object.assign(this, { element, command, motions, frames, rate, onChosen, kept: new Set() });
    this.rows = findings.map((finding, at) => {
      const moved = movedMost(motions, finding);
      return { finding, number: at + 1, moved, mover: motions[0].names[moved.at] };
    });
    this.repaired = this.rows.filter(({ finding }) => statusOf(finding) === "repaired");
    this.repaired.forEach(({ number }) => this.kept.add(number));
    this.list = element(box, "div", { className: "list" });
    this.pane = element(box, "div", { className: "detail", role: "region", ariaLabel: "The chosen finding" });
    if (command && this.repaired.length) {
      const all = element(this.list, "div", { className: "all" });
      this.said = element(all, "p");
      this.code = this.commandLine(all, "");
      this.sayWhatIsKept();
    }
    for (const [status, heading] of SECTIONS) this.section(this.rows.filter(({ finding }) => statusOf(finding) === status), heading);
    PHONE.addEventListener("change", () => this.placeDetail());
  }

  section(rows, heading) {
    if (!rows.length) return;
    this.element(this.list, "h2", { textContent: heading(rows.length) });
    const list = this.element(this.list, "ol");
    const events = new Map();
    for (const row of rows) {
      const event = row.finding.event ?? `of its own ${row.number}`;
      events.set(event, [...events.get(event) ?? [], row]);
    }
    for (const ofEvent of events.values()) {
      if (ofEvent.length === 1) this.item(list, ofEvent[0]);
      else this.event(list, ofEvent);
    }
  }

  // Findings along a limb: a line for all, which unfolds.
  event(list, rows) {
    const item = this.element(list, "li"), fold = this.element(item, "details", { className: "event" });
    const [largest] = rows, frames = rows.map(({ finding }) => finding.frames);
    const ends = [Math.min(...frames.map(([first]) => first)), Math.max(...frames.map(([, last]) => last))];
    const summary = this.element(fold, "summary");
    this.element(summary, "b", { textContent: spaced(largest.finding.place) });
    const parts = [framesOf(ends), `${rows.length} findings`, movement(largest.finding, largest.mover)];
    this.element(summary, "span", { textContent: parts.filter(Boolean).join(" \u00b7 ") });
    const inner = this.element(fold, "ol");
    rows.forEach((row) => {
      this.item(inner, row);
      row.fold = fold;
    });
    summary.addEventListener("click", () => {
      if (!fold.open) this.choose(largest);
    });
  }

  item(list, row) {
    const { finding, number, mover } = row, item = this.element(list, "li");
    const button = this.element(item, "button", { type: "button", ariaPressed: "false" });
    this.element(button, "b", { textContent: `${number}. ${spaced(finding.joint)}` });
    const parts = [framesOf(finding.frames), finding.kind, movement(finding, mover, finding.joint)];
    this.element(button, "span", { textContent: parts.filter(Boolean).join(" \u00b7 ") });
    Object.assign(row, { item, button });
    button.addEventListener("click", () => {
      this.choose(row);
      button.scrollIntoView?.({ block: "nearest" });
    });
  }

  // Show the details of a finding, and its frames.
  choose(row) {
    this.chosen = row;
    for (const { button, number } of this.rows) button.ariaPressed = String(number === row.number);
    if (row.fold) row.fold.open = true;
    this.pane.replaceChildren();
    this.fill(row);
    this.placeDetail();
    this.onChosen(row);
  }

  // Beside the list, or on a phone below the finding's line.
  placeDetail() {
    if (PHONE.matches && this.chosen) this.chosen.item.append(this.pane);
    else this.list.after(this.pane);
  }

  // On paper every event is unfolded; afterwards those that were folded are so again.
  unfold(isPrinted) {
    if (isPrinted) this.folded = [...this.list.querySelectorAll(".event:not([open])")];
    this.folded?.forEach((fold) => { fold.open = isPrinted; });
  }

  fill({ finding, number, moved }) {
    const { pane } = this, { evidence, confidence } = finding;
    const sure = confidence === undefined ? "" : `Confidence ${Math.round(100 * confidence)}%.`;
    this.element(pane, "h3", { textContent: `${number}. ${spaced(finding.joint)}, ${framesOf(finding.frames)}` });
    this.element(pane, "p", { textContent: [evidence && `${evidence[0].toUpperCase()}${evidence.slice(1)}.`, sure].filter(Boolean).join(" ") });
    this.curve(pane, finding, moved);
    if (!this.command || statusOf(finding) === "kept") return;
    if (statusOf(finding) !== "repaired") {
      this.element(pane, "p", { textContent: "For a file in which this alone is repaired:" });
      this.commandLine(pane, onlyCommand(this.command, [number], `finding_${number}`));
      return;
    }
    if (this.repaired.length < 2) return;
    const label = this.element(pane, "label");
    const box = this.element(label, "input", { type: "checkbox", checked: this.kept.has(number) });
    label.append("keep this repair");
    box.addEventListener("change", () => this.keep(number, box.checked));
    const alone = this.element(pane, "details");
    this.element(alone, "summary", { textContent: "this repair alone, without the others" });
    this.commandLine(alone, onlyCommand(this.command, [number], `finding_${number}`));
  }

  keep(number, kept) {
    this.kept[kept ? "add" : "delete"](number);
    this.repaired.forEach((row) => row.button.classList.toggle("rejected", !this.kept.has(row.number)));
    this.sayWhatIsKept();
  }

  // What the written file has, and, where not every box is ticked, the command that writes what is ticked.
  sayWhatIsKept() {
    const all = this.repaired.length, numbers = [...this.kept].sort((a, b) => a - b);
    const some = numbers.length > 0 && numbers.length < all;
    const written = `The written file has ${all > 1 ? `all ${all} repairs` : "this repair"}.`;
    const ticked = numbers.length ? "Untick one that is wrong to get a command that leaves it out." : "None is kept: use the file before.";
    this.said.textContent = `${written} ${some ? `For a file with the ${numbers.length} that are ticked, run:` : all > 1 ? ticked : ""}`;
    for (const part of [this.code, this.code.nextSibling]) part.hidden = !some;
    this.code.textContent = onlyCommand(this.command, numbers, "kept");
  }

  curve(pane, finding, { at, axis }) {
    const [first, last] = finding.frames, around = Math.round(this.rate / 2);
    const from = Math.max(first - around, 0), to = Math.min(last + around, this.frames - 1);
    const { names } = this.motions[0], pair = this.motions.slice(0, 2).filter((motion) => motion.names[at] === names[at]);
    const curves = pair.map((motion) => ({
      colour: motion.colour, values: Float32Array.from({ length: to - from + 1 }, (_, i) => placeOf(motion, from + i, at, axis)),
    }));
    const name = `${AXES[axis]} of ${spaced(names[at])}${at ? " from the hips" : ""}`;
    const canvas = this.element(pane, "canvas", { width: 2 * WIDTH, height: 2 * HEIGHT, role: "img" });
    const pen = canvas.getContext("2d");
    pen.scale(2, 2);
    const across = (frame) => (frame - from) / Math.max(to - from, 1) * WIDTH;
    pen.fillStyle = TINT;
    pen.fillRect(across(first), 0, Math.max(across(last) - across(first), 1), HEIGHT);
    const [low, high] = strokeCurves(pen, curves, 0, WIDTH, HEIGHT);
    const text = `${name}, ${low.toFixed(2)} to ${high.toFixed(2)} m, frames ${from} to ${to}: before orange, after blue`;
    canvas.ariaLabel = text;
    this.element(pane, "p", { className: "caption", textContent: text });
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
