"""The words of `repair` and `fill`: what is said of one file in the terminal and on its page."""

import argparse
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup import PRESETS, Repaired
from numpy_cae.cleanup.events import Event, group_findings
from numpy_cae.cleanup.finding import KEPT_REASON, LEFT_REASON, Finding
from numpy_cae.cleanup.kinds import FOOT
from numpy_cae.cleanup.measures import Measures, is_larger, measure_damage
from numpy_cae.cleanup.presets import fitting_preset, kinks_to_smooth
from numpy_cae.cleanup.words import (
    MOST_PRINTED,
    NOTHING_FOUND,
    count,
    cuts_in_words,
    joints_by_frames,
    joints_in_words,
)
from numpy_cae.motion import Motion

UNCHANGED, UNLIKE = 3, 4
"""Exit statuses of one file in which nothing was changed; of one that is also unlike what the model
learned from."""
TRY = (
    "nothing was changed. If something is wrong all the same: check the up axis (--up) and the "
    "joints (`numpy-cae rig`), name what is damaged (--joint, --frames), or where the motion is "
    "from (--from)"
)
ANYWAY = (
    "to repair one of them alone: --only and its number; to repair it with the rest: write the "
    'list with --findings f.json, add "accept": true to the finding, then --mask f.json'
)
NOT_DONE = {
    "proposed": "proposed, not changed",
    "left": "found, left alone",
    "kept": "kept as it is",
}
"""What is said of findings of a status that were not repaired."""
REASONS = {"proposed": "not certain enough", "left": LEFT_REASON, "kept": KEPT_REASON}
"""Why findings of a status were not repaired."""
FITS = {"video": "shakes and whose feet slide", "suit": "begins with a pose of reference"}
"""The motion that a preset fits which `fitting_preset` names."""
MEASURE_NAMES = ("frames with a jump", "feet slide, cm/s", "jitter, m/s²")
"""The fields of `Measures` in words, with their units."""
NOT_REPEATED = "command run files output dry_run overwrite html findings only".split()
"""What the command of one finding does not repeat: it writes another file and no list."""


class Numbers(NamedTuple):
    """The numbers of one file, or the sums of several.

    Parameters
    ----------
    findings : int
    proposals : int
    changed, seconds : float
        Seconds that were changed, and all seconds.
    jumps, jumps_after : float
        Frames with a jump before and after.
    """

    findings: int
    proposals: int
    changed: float
    seconds: float
    jumps: float
    jumps_after: float

    def __str__(self) -> str:
        """The numbers in words; no findings where all was asked for."""
        parts = []
        if self.findings or not self.changed:
            parts.append(count(self.findings, "finding"))
        if self.proposals:
            parts.append(count(self.proposals, "proposal"))
        parts.append(f"{self.changed:.1f} of {self.seconds:.1f} s changed")
        parts.append(f"frames with a jump {self.jumps:.0f} → {self.jumps_after:.0f}")
        return ", ".join(parts)


class Summary(NamedTuple):
    """What is said of one file.

    Parameters
    ----------
    status : int
        The exit status if the file is the only one: 0, `UNCHANGED` or `UNLIKE`.
    numbers : Numbers
    sentences : list of str
    measures : list of (str, str, str)
        The name of each measure with its unit, and its value before and after.
    title : str
        Of the page.
    command : str
        The command that repairs one finding, for the page; "" where there is none.
    """

    status: int
    numbers: Numbers
    sentences: list[str]
    measures: list[tuple[str, str, str]]
    title: str
    command: str = ""


def summary_of_repair(
    args: argparse.Namespace, source: Path, target: Path | None, motion: Motion, repaired: Repaired
) -> Summary:
    """What is said of a file after `repair`."""
    status = 0
    if not repaired.touched.any() and len(repaired.motion) == len(motion):
        status = UNCHANGED if repaired.is_familiar else UNLIKE
    sentences = [_findings_by_kind(repaired), *_sentences(repaired)]
    if not asks_for_more(args):
        command = command_of(args, source, target or Path("fixed.bvh"))
        if args.html:
            command += " --html"
        sentences += _advice(repaired, command)
    if status == UNLIKE:
        sentences.append(TRY)
    before, after = measure_damage(motion), measure_damage(repaired.motion)
    measures = _measures_in_words(before, after)
    title = f"{source.name}: before and after"
    command = ""
    if target is not None:
        # The page writes the number of the finding in the name of the file, and adds --only.
        command = command_of(args, source, target.with_stem(f"{target.stem}_finding_0"))
    return Summary(
        status, _numbers(motion, repaired, before, after), sentences, measures, title, command
    )


def summary_of_filling(source: Path, motion: Motion, repaired: Repaired) -> Summary:
    """What is said of a file after `fill`, which changes it in any case."""
    before, after = measure_damage(motion), measure_damage(repaired.motion)
    measures = []
    for name, value, value_after in _measures_in_words(before, after):
        if value != value_after:
            measures.append((name, value, value_after))
    title = f"{source.name}, {_filled_in_words(repaired)}"
    numbers = _numbers(motion, repaired, before, after)
    return Summary(0, numbers, _sentences(repaired), measures, title)


def asks_for_more(args: argparse.Namespace) -> bool:
    """Whether the user asks for smoothing or feet, or names where the motion is from."""
    return bool(args.source or args.smooth or args.feet)


def _can_be_accepted(finding: Finding) -> bool:
    """Whether a finding that was not repaired is repaired if the user accepts it: feet are held,
    whoever found them, only where no more frames jump (`feet.mend_feet`)."""
    return finding.status in ("proposed", "left") and finding.row is not FOOT


def details_in_words(repaired: Repaired) -> list[str]:
    """The largest events with the numbers of their findings, then what is not changed; without any,
    the joints."""
    if not repaired.listed():
        return repr(repaired).splitlines() if repaired.touched.any() else []
    mended = []
    unchanged: dict[str, list[list[str]]] = {}
    for event, numbers in _numbered_events(repaired):
        if event.largest.is_repaired:
            mended.append(_event_in_words(event, numbers))
        else:
            texts = [replace(finding, status="repaired") for finding in event.findings]
            unchanged.setdefault(event.largest.status, []).append(
                # Without the status, whose reason is printed once, above.
                _event_in_words(replace(event, findings=tuple(texts)), numbers)
            )
    lines = _first_events(mended)
    for status, events in unchanged.items():
        lines.append(f"{NOT_DONE[status]}:")
        lines += [f"  {line}" for line in _first_events(events)]
    if any(_can_be_accepted(finding) for finding in repaired.listed()):
        lines.append(ANYWAY)
    return lines


def _numbered_events(repaired: Repaired) -> Iterator[tuple[Event, range]]:
    """The events with the numbers of their findings, which count from 1."""
    start = 1
    for event in repaired.events():
        yield event, range(start, start + len(event.findings))
        start += len(event.findings)


def _event_in_words(event: Event, numbers: range) -> list[str]:
    """A line for each finding; of several, after one for the event."""
    lines = []
    for number, finding in zip(numbers, event.findings, strict=True):
        lines.append(f"{number}. {finding}")
    if len(lines) == 1:
        return lines
    return [f"{event}", *[f"  {line}" for line in lines]]


def _first_events(events: Sequence[list[str]]) -> list[str]:
    """The lines of the first events, and how many more there are."""
    lines = []
    for event in events[:MOST_PRINTED]:
        lines += event
    if len(events) > MOST_PRINTED:
        lines.append(f"  and {len(events) - MOST_PRINTED} more")
    return lines


def measures_in_line(measures: Sequence[tuple[str, str, str]]) -> str:
    """Measures before and after in one line."""
    return "; ".join(f"{name}: {before} → {after}" for name, before, after in measures)


def command_of(args: argparse.Namespace, source: Path, target: Path) -> str:
    """This command for one file, into `target`, with every option that changes the result."""
    words = ["numpy-cae", "repair", source, "-o", target]
    for name, value in vars(args).items():
        if name in NOT_REPEATED or value in (None, False, []):
            continue
        option = "--from" if name == "source" else f"--{name}"
        if value is True:
            words.append(option)
        elif not isinstance(value, list):
            words.append(f"{option}={value}")
        elif len(value) == 1 or name == "mapping":
            words += [f"{option}={item}" for item in value]
        else:
            words += [option, *value]
    return " ".join(quote(str(word)) for word in words)


def _numbers(motion: Motion, repaired: Repaired, before: Measures, after: Measures) -> Numbers:
    changed = np.count_nonzero(repaired.touched.any(axis=1)) / motion.rate
    seconds = repaired.motion.seconds
    findings = len(repaired.findings)
    proposals = sum(finding.status == "proposed" for finding in repaired.proposed)
    return Numbers(findings, proposals, changed, seconds, before.jumps, after.jumps)


def _findings_by_kind(repaired: Repaired) -> str:
    """How many findings were mended, of which kinds, in how many events if these are fewer."""
    text = count(len(repaired.findings), "finding")
    numbers = Counter(finding.kind for finding in repaired.findings)
    if numbers:
        text += ": " + ", ".join(f"{kind} {number}" for kind, number in numbers.most_common())
    events = len(group_findings(repaired.findings))
    if events < len(repaired.findings):
        text += f"; {count(events, 'event')}"
    return text


def _sentences(repaired: Repaired) -> list[str]:
    """What was changed, and what a user should know about it."""
    changed = repaired.touched.any(axis=1).sum() / repaired.motion.rate
    sentences = [f"{changed:.1f} of {repaired.motion.seconds:.1f} s are changed"]
    if repaired.cuts:
        sentences.append(cuts_in_words(repaired.cuts))
    for status, number in Counter(finding.status for finding in repaired.proposed).items():
        sentences.append(f"{number} {NOT_DONE[status]}, since {REASONS[status]}")
    if not repaired.is_familiar:
        sentences.append(
            "unlike what the model knows: used only smoothing and filters, no prediction"
        )
    return sentences


def _advice(repaired: Repaired, command: str) -> list[str]:
    """Which preset fits the motion, and whether smoothing does, with the commands."""
    name = fitting_preset(repaired.original) if repaired.original else None
    sentences = []
    if name is not None:
        steps = f"--from {name} suits a motion that {FITS[name]}, as this does: {PRESETS[name]}"
        sentences.append(f"not done yet: {steps}. The command: {command} --from {name}")
    kinks = kinks_to_smooth(repaired.motion)
    if kinks and not (name and PRESETS[name].smooth):
        steps = f"--smooth removes jitter: joints stop or start within a frame {kinks} times"
        sentences.append(f"not done yet: {steps}. The command: {command} --smooth")
    return sentences


def _measures_in_words(before: Measures, after: Measures) -> list[tuple[str, str, str]]:
    """The name of each measure and its values before and after; a value after is marked if it is
    worse (`measures.is_larger`)."""
    rows = []
    for name, value, value_after in zip(MEASURE_NAMES, before, after, strict=True):
        text_after = f"{round(value_after, 1):.10g}"
        if is_larger(value, value_after):
            text_after += " (worse)"
        rows.append((name, f"{round(value, 1):.10g}", text_after))
    return rows


def _filled_in_words(repaired: Repaired) -> str:
    """What `fill` filled in, such as "filled: left wrist, frames 30 to 75"."""
    parts = []
    for frames, joints in joints_by_frames(repaired.touched).items():
        parts.append(f"{joints_in_words(joints).replace('_', ' ')}, {frames}")
    text = "; ".join(parts[:MOST_PRINTED]) or NOTHING_FOUND
    if len(parts) > MOST_PRINTED:
        text += " and more"
    return f"filled: {text}"
