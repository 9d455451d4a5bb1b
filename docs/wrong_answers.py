"""Fifty-one wrong answers to exercises of the lessons, and what their reports say first.

    python docs/wrong_answers.py

docs/wrong_answers.md has the table.

A wrong answer is one of the right ones in tests/course/right_styles.txt, which are not those from
which the named mistakes are made, with a piece of its text replaced.
"""

import re
from pathlib import Path

import numpy as np

from numpy_cae.course.catalogue import CATALOGUE, EXERCISES
from numpy_cae.verify.operations.trial import failing_case, try_property

STYLES = re.split(
    r"\n(?=def )",
    (Path(__file__).parents[1] / "tests" / "course" / "right_styles.txt").read_text("utf-8"),
)
SLIPS = (
    ("square", "upstream forgotten", 0, "dy * 2.0 * x", "2.0 * x"),
    ("square", "factor 2 forgotten", 1, "2 * dy * x", "dy * x"),
    ("chain_to_root", "root forgotten", 0, "return (joint,)\n", "return ()\n"),
    ("rotation_from_channels", "radians for degrees", 0, "degrees * np.pi / 180", "degrees"),
    ("rotation_from_channels", "reversed order", 0, "np.dot(result, m)", "np.dot(m, result)"),
    (
        "forward_kinematics",
        "own rotation",
        1,
        "g[:, k], translations",
        "rotations[:, j], translations",
    ),
    (
        "forward_kinematics",
        "parent's local rotation",
        0,
        "world[p].dot(translations",
        "rotations[f, p].dot(translations",
    ),
    (
        "forward_kinematics",
        "product reversed",
        1,
        "np.matmul(g[:, k], rotations[:, j])",
        "np.matmul(rotations[:, j], g[:, k])",
    ),
    ("speeds", "not multiplied by the rate", 1, " * rate", ""),
    (
        "heading_angle",
        "faces backwards",
        0,
        "-across[:, 2], across[:, 0]",
        "across[:, 2], -across[:, 0]",
    ),
    (
        "heading_angle",
        "no unwrap",
        0,
        "np.unwrap(np.arctan2(-across[:, 2], across[:, 0]))",
        "np.arctan2(-across[:, 2], across[:, 0])",
    ),
    ("turn_about_y", "turns the other way", 1, "r.transpose(0, 2, 1)", "r"),
    ("to_features", "height subtracted", 1, "[1, 0, 1]", "[1, 1, 1]"),
    ("to_features", "last row 0", 0, "    out[-1, 60:] = out[-2, 60:]\n", ""),
    (
        "from_features",
        "own turn added",
        1,
        "np.concatenate([[0.0], np.cumsum(features[:-1, 62])])",
        "np.cumsum(features[:, 62])",
    ),
    ("conv1d_by_loops", "taps flipped", 0, "t + k - K // 2", "t - k + K // 2"),
    ("unfold", "float64 zeros", 1, "(B, T, taps, C), x.dtype", "(B, T, taps, C)"),
    (
        "transpose_filters",
        "not flipped in time",
        0,
        "np.swapaxes(w[::-1], 1, 2), lambda dw: np.swapaxes(dw, 1, 2)[::-1]",
        "np.swapaxes(w, 1, 2), lambda dw: np.swapaxes(dw, 1, 2)",
    ),
    ("conv1d", "filters not flipped in dx", 1, "@ w[k].T", "@ w[K - 1 - k].T"),
    ("conv1d", "db as a mean", 0, "dy.sum((0, 1))", "dy.mean((0, 1))"),
    ("max_pool", "ties to both", 0, "(~first)", "(b >= a)"),
    (
        "max_pool",
        "gradient to both frames",
        0,
        "first * dy\n        dx[:, 1::2] = (~first) * dy",
        "dx[:, 1::2] = dy",
    ),
    (
        "unpool_even",
        "the earlier frame's gradient alone",
        0,
        "(dx[:, ::2] + dx[:, 1::2]) / 2",
        "dx[:, ::2] / 2",
    ),
    (
        "unpool_even",
        "value not halved",
        0,
        "y.repeat(2, axis=1) / 2, lambda dx: (dx[:, ::2] + dx[:, 1::2]) / 2",
        "y.repeat(2, axis=1), lambda dx: dx[:, ::2] + dx[:, 1::2]",
    ),
    ("tanh", "1 - x²", 1, "np.square(t)", "np.square(x)"),
    ("arctanh", "gradient beyond the bound", 1, "        dy[np.abs(y) > bound] = 0\n", ""),
    ("decode_layer", "minus sign of db", 0, "-np.sum(du, axis=(0, 1))", "np.sum(du, axis=(0, 1))"),
    ("project_layer", "decoder's dW forgotten", 1, "np.add(h[1], g[1])", "h[1]"),
    (
        "project_layer",
        "decoder's dW and db forgotten",
        1,
        "np.add(h[1], g[1]), np.add(h[2], g[2])",
        "h[1], h[2]",
    ),
    ("mean_squared_error", "factor 2 forgotten", 0, "dloss * 2 * d", "dloss * d"),
    ("mean_absolute", "not divided by the count", 0, "np.sign(y) / y.size", "np.sign(y)"),
    ("zero_values", "kept where it should be lost", 1, "draws >= p", "draws < p"),
    ("sgd_step", "uphill", 0, "parameter - rate", "parameter + rate"),
    ("layer_loss", "decoder's dW forgotten", 0, "dw + back_w(dwt)", "dw"),
    ("layer_loss", "sparsity without a gradient", 0, " + alpha * np.sign(y) / y.size", ""),
    ("train_layer", "no new order", 0, "windows[rng.permutation(len(windows))]", "windows"),
    ("stack_loss", "encoder's share forgotten", 0, "dw[i] + a, db[i] + c", "dw[i], db[i]"),
    (
        "rescale",
        "over the whole batch",
        0,
        "np.mean(window[:, moving]",
        "np.mean(x[:, :, moving]",
    ),
    (
        "denoising_weights",
        "k² on the diagonal",
        1,
        "    k[np.arange(len(k)), np.arange(len(k))] = kept\n",
        "",
    ),
    ("fill_unknown", "known values projected", 0, "    out[known] = x[known]\n", ""),
    ("G", "without squares", 0, " ** 2", ""),
    ("G", "square root", 1, "float(a @ a)", "float(a @ a) ** 0.5"),
    (
        "gru_step",
        "z and 1 - z exchanged",
        0,
        "return (1 - z) * n + z * h, back",
        "return z * n + (1 - z) * h, back",
    ),
    ("gru", "state's gradient not carried", 0, "back(d + dh)", "back(d)"),
    (
        "clip_gradients",
        "each array for itself",
        0,
        "[g * bound / norm for g in gradients]",
        "[g * min(1, bound / np.linalg.norm(g)) for g in gradients]",
    ),
    ("self_fed", "fed-back path forgotten", 0, "d = dy[:, t] + dx", "d = dy[:, t]"),
    ("write_clips", "not reversed", 0, "np.flip(y, axis=1), pullback", "y, pullback"),
    ("wasserstein_1d", "q not sorted", 0, "q[j]", "q"),
    ("sliced_wasserstein", "sum in place of the mean of slices", 0, " / len(directions)", ""),
    ("central_differences", "divided by h", 1, " / h / 2", " / h"),
    (
        "check_gradients",
        "dy all ones",
        0,
        "np.random.default_rng(3).normal(size=np.shape(value))",
        "np.ones(np.shape(value))",
    ),
)


def wrong_answer(name: str, style: int, old: str, new: str):
    """A right answer with a piece of its text replaced, as a function."""
    source = [each for each in STYLES if each.startswith(f"def {name}(")][style]
    if old not in source:
        raise ValueError(f"{name}: no {old!r}")
    space = {"np": np, **{each: one.solution for each, one in CATALOGUE.items()}}
    exec(source.replace(old, new), space)
    return space[name]


if __name__ == "__main__":
    print("| exercise | slip | fails first | what it says | likely |\n|---|---|---|---|---|")
    for name, slip, *replaced in SLIPS:
        function = wrong_answer(name, *replaced)
        failing = (p for p in EXERCISES[name].properties if failing_case(p, function) is not None)
        first = next(failing, None)
        if first is None:
            print(f"| `{name}` | {slip} | accepted | | |", flush=True)
            continue
        outcome = try_property(first, function)
        what = outcome.problem.splitlines()[0].replace("|", "\\|")
        print(f"| `{name}` | {slip} | {first.name} | {what} | {outcome.mistake} |", flush=True)
