"""The solutions of lessons 09 to 14: the second paper, checks of gradients, speed, projects."""

import numpy as np

from numpy_cae.ops import gru, gru_step, linear, mean_squared_error, sliced_wasserstein


def norms_through_time(pull, dh, frames):
    """|dL/dh_t| for t = 0, ..., frames."""
    norms = np.empty(frames + 1)
    norms[frames] = np.linalg.norm(dh)
    for t in range(frames, 0, -1):
        dh = pull(t, dh)
        norms[t - 1] = np.linalg.norm(dh)
    return norms


def gate_gradients(dh_next, h, r, z, n, s_n):
    """da_r, da_z, da_n and ds_n of a GRU's step, from the last line of the step to the first."""
    dn = dh_next * (1 - z)
    dz = dh_next * (h - n)
    da_n = dn * (1 - n * n)
    dr = da_n * s_n
    return dr * r * (1 - r), dz * z * (1 - z), da_n, da_n * r


def clip_gradients(gradients, bound):
    """g · min(1, bound / |g|) as new arrays, and |g| of all together."""
    norm = np.sqrt(sum(float(np.sum(each * each)) for each in gradients))
    factor = bound / norm if norm > bound else 1.0
    return [factor * each for each in gradients], norm


def read_clips(weights, x):
    """From clips to z: the last state of a GRU, made linear; and its pullback."""
    w, u, b, c = (weights[f"encoder_{letter}"] for letter in "wubc")
    start = np.zeros((len(x), len(u)), dtype=u.dtype)
    states, gru_back = gru(x, start, w, u, b, c)
    z, latent_back = linear(states[:, -1], weights["latent_w"], weights["latent_b"])

    def pullback(dz):
        d_states = np.zeros_like(states)
        d_states[:, -1], d_latent_w, d_latent_b = latent_back(dz)
        _, _, dw, du, db, dc = gru_back(d_states)
        return {
            "encoder_w": dw,
            "encoder_u": du,
            "encoder_b": db,
            "encoder_c": dc,
            "latent_w": d_latent_w,
            "latent_b": d_latent_b,
        }

    return z, pullback


def self_fed(h, frames, w, u, b, c, frame_w, frame_b):
    """The frames of a GRU that reads its own last frame, first zeros; and its pullback."""
    frame = np.zeros((len(h), len(frame_b)), dtype=h.dtype)
    written, step_backs, frame_backs = [], [], []
    for _ in range(frames):
        h, step_back = gru_step(frame, h, w, u, b, c)
        frame, frame_back = linear(h, frame_w, frame_b)
        written.append(frame)
        step_backs.append(step_back)
        frame_backs.append(frame_back)

    def pullback(dy):
        totals = [np.zeros_like(each) for each in (w, u, b, c, frame_w, frame_b)]
        d_fed, dh = np.zeros_like(frame), np.zeros_like(h)
        for k in reversed(range(frames)):
            dh_of_frame, *of_frame = frame_backs[k](dy[:, k] + d_fed)
            d_fed, dh, *of_step = step_backs[k](dh_of_frame + dh)
            for total, part in zip(totals, of_step + of_frame, strict=True):
                total += part
        return (dh, *totals)

    return np.stack(written, axis=1), pullback


def write_clips(weights, z, frames):
    """From z to clips, written from the last frame to the first; and its pullback."""
    names = [f"decoder_{letter}" for letter in "wubc"] + ["frame_w", "frame_b"]
    h, state_back = linear(z, weights["state_w"], weights["state_b"])
    written, loop_back = self_fed(h, frames, *(weights[name] for name in names))

    def pullback(dx_hat):
        dh, *of_loop = loop_back(dx_hat[:, ::-1])
        dz, d_state_w, d_state_b = state_back(dh)
        gradients = dict(zip(names, of_loop, strict=True))
        return dz, {"state_w": d_state_w, "state_b": d_state_b, **gradients}

    return written[:, ::-1], pullback


def reconstruction_loss(weights, x):
    """The mean squared error of reconstructed clips, and its gradients by name."""
    z, read_back = read_clips(weights, x)
    x_hat, write_back = write_clips(weights, z, x.shape[1])
    loss, error_back = mean_squared_error(x_hat, x)
    dz, of_writing = write_back(error_back())
    return loss, {**read_back(dz), **of_writing}


def wasserstein_1d(p, q):
    """The squared 2-Wasserstein distance of two sets of numbers; and its pullback."""
    order = np.argsort(p)
    gap = p[order] - np.sort(q)

    def pullback(dloss=1.0):
        dp = np.empty_like(gap)
        dp[order] = (2 * float(dloss) / len(gap)) * gap
        return dp

    return np.mean(gap * gap), pullback


def regularised_loss(weights, x, prior, directions, weight):
    """Reconstruction + λ · discrepancy, and its gradients by name."""
    z, read_back = read_clips(weights, x)
    x_hat, write_back = write_clips(weights, z, x.shape[1])
    error, error_back = mean_squared_error(x_hat, x)
    discrepancy, discrepancy_back = sliced_wasserstein(z, prior, directions)

    dz, of_writing = write_back(error_back())
    of_reading = read_back(dz + discrepancy_back(weight))
    return error + weight * discrepancy, {**of_reading, **of_writing}


def central_differences(f, x, h):
    """(f(x + h) - f(x - h)) / 2h for every entry of x."""
    slopes = np.empty(x.shape)
    for index in np.ndindex(x.shape):
        step = np.zeros(x.shape)
        step[index] = h
        slopes[index] = (f(x + step) - f(x - step)) / (2 * h)
    return slopes


def adjoint_gap(f, x, y):
    """|<A x, y> - <x, A' y>| relative to the norms of the factors."""
    value, pullback = f(x)
    pulled = pullback(y)
    size = np.linalg.norm(value) * np.linalg.norm(y) + np.linalg.norm(x) * np.linalg.norm(pulled)
    return abs(np.sum(value * y) - np.sum(x * pulled)) / size


def check_gradients(f, inputs):
    """Raise an AssertionError unless the pullback of f agrees with differences."""
    value, pullback = f(*inputs.values())
    dy = np.random.default_rng(0).standard_normal(np.shape(value))
    gradients = pullback(dy)
    if len(inputs) == 1:
        gradients = (gradients,)
    for (name, x), gradient in zip(inputs.items(), gradients, strict=True):

        def loss(moved, name=name):
            return np.sum(dy * f(*{**inputs, name: moved}.values())[0])

        numeric = central_differences(loss, x, 1e-5 * np.abs(x).max())
        assert np.shape(gradient) == x.shape, f"the gradient for {name} has the wrong shape"
        gap = np.linalg.norm(gradient - numeric)
        allowed = 1e-6 * (np.linalg.norm(gradient) + np.linalg.norm(numeric))
        assert gap <= allowed, f"the gradient for {name} is wrong, by {gap:.2g}"


def three_products(alpha, beta, p, q, multiply):
    """Real and imaginary part of (α + i β)(p + i q), after Gauss."""
    m1 = multiply(alpha + beta, p)
    m2 = multiply(alpha, q - p)
    m3 = multiply(beta, p + q)
    return m1 - m3, m1 + m2


def one_frequency(frequency, taps, frames):
    """The rows of A and G and the columns of C of one frequency: three, or one if it is real."""
    points = frames + taps - 1
    angles = 2 * np.pi * frequency / points * np.arange(points)
    cos, sin = np.cos(angles), np.sin(angles)
    cos_k, sin_k = cos[:taps], sin[:taps]
    cos_t, sin_t = cos[:frames] / points, sin[:frames] / points
    if 2 * frequency in (0, points):
        return cos[None], cos_k[None], cos_t[:, None]
    a = np.array([cos - sin, cos, -sin])
    g = np.array([cos_k, sin_k - cos_k, cos_k + sin_k])
    c = np.array([2 * (cos_t - sin_t), -2 * sin_t, -2 * cos_t])
    return a, g, c.T


def block_matrices(taps, frames):
    """A, G and C: transforms of a block and of a filter, and the transform back."""
    points = frames + taps - 1
    every = [one_frequency(f, taps, frames) for f in range(points // 2 + 1)]
    a, g, c = zip(*every, strict=True)
    return np.concatenate(a), np.concatenate(g), np.concatenate(c, axis=1)


def conv1d_by_blocks(x, w, b, a, g, c):
    """The convolution by A, G and C, and its pullback."""
    (batch, frames, channels), (taps, _, filters) = x.shape, w.shape
    (products, points), length = a.shape, len(c)
    before, count = taps // 2, -(-frames // length)
    starts = range(0, count * length, length)

    def by_product(blocks):
        return blocks.transpose(1, 0, 2).reshape(products, count * batch, -1)

    def by_block(each_product):
        return each_product.reshape(products, count, -1).transpose(1, 0, 2)

    padded = np.zeros((count * length + taps - 1, batch, channels), dtype=x.dtype)
    padded[before : before + frames] = x.transpose(1, 0, 2)
    read = np.stack([padded[s : s + points].reshape(points, -1) for s in starts])
    u = by_product(a @ read)
    w_hat = np.tensordot(g, w, 1)
    v = u @ w_hat
    y = (c @ by_block(v)).reshape(count * length, batch, filters)

    def pullback(dy):
        dy_rows = np.zeros((count * length, batch, filters), dtype=dy.dtype)
        dy_rows[:frames] = dy.transpose(1, 0, 2)
        dv = by_product(c.T @ dy_rows.reshape(count, length, -1))
        dw = np.tensordot(g.T, u.transpose(0, 2, 1) @ dv, 1)
        du = dv @ w_hat.transpose(0, 2, 1)
        d_read = (a.T @ by_block(du)).reshape(count, points, batch, channels)
        d_padded = np.zeros(padded.shape, dtype=x.dtype)
        for s, part in zip(starts, d_read, strict=True):
            d_padded[s : s + points] += part
        dx = d_padded[before : before + frames].transpose(1, 0, 2)
        return dx, dw, dy.sum(axis=(0, 1))

    return y[:frames].transpose(1, 0, 2) + b, pullback


def bones_off(q, lengths, parents):
    """mean (|bone| - length)², and its pullback."""
    ends = [joint for joint, parent in enumerate(parents) if parent != -1]
    starts = [parents[joint] for joint in ends]
    bones = q[:, ends] - q[:, starts]
    measured = np.linalg.norm(bones, axis=-1, keepdims=True)
    gap = measured - lengths[ends][:, None]

    def pullback(dloss=1.0):
        d_bones = dloss * 2 * gap / gap.size * bones / measured
        dq = np.zeros_like(q)
        for n, (end, start) in enumerate(zip(ends, starts, strict=True)):
            dq[:, end] += d_bones[:, n]
            dq[:, start] -= d_bones[:, n]
        return dq

    return np.mean(gap**2), pullback


def path_energy(path):
    """N Σ |X_{i+1} - X_i|², and its pullback."""
    steps = np.diff(path, axis=0)

    def pullback(dloss=1.0):
        d = np.zeros_like(path)
        d[1:] += 2 * dloss * len(steps) * steps
        d[:-1] -= 2 * dloss * len(steps) * steps
        return d

    return len(steps) * np.sum(steps**2), pullback


def observed_error(x_hat, x, known):
    """mean (x̂ - x)² over the known values, and its pullback."""
    difference = np.where(known, x_hat - x, 0.0)
    count = known.sum()

    def pullback(dloss=1.0):
        return 2 * dloss / count * difference

    return np.sum(difference**2) / count, pullback
