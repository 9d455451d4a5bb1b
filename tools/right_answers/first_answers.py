"""A right answer to each exercise, as a student may hand it in: unlike the key."""

# ruff: noqa: B023, B905, F841, RUF059 -- students write so

import numpy as np

from numpy_cae.ops import sigmoid  # lesson 09 has it


def square(x):
    return x * x, lambda dy: dy * 2.0 * x


def chain_to_root(parents, joint):
    if parents[joint] == -1:
        return (joint,)
    return (joint,) + chain_to_root(parents, parents[joint])


def rotation_from_channels(axes, angles):
    result = np.identity(3)
    for axis, degrees in zip(axes, angles):
        a = degrees * np.pi / 180
        c, s = np.cos(a), np.sin(a)
        if axis == 0:
            m = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        elif axis == 1:
            m = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        else:
            m = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        result = np.dot(result, m)
    return result


def forward_kinematics(parents, rotations, translations):
    frames, joints = translations.shape[:2]
    result = np.zeros((frames, joints, 3))
    for f in range(frames):
        world = {}
        for j in range(joints):
            p = parents[j]
            if p == -1:
                world[j] = rotations[f, j]
                result[f, j] = translations[f, j]
            else:
                world[j] = world[p].dot(rotations[f, j])
                result[f, j] = result[f, p] + world[p].dot(translations[f, j])
    return result


def speeds(positions, rate):
    return np.linalg.norm(positions[1:] - positions[:-1], axis=2) / (1 / rate)


def heading_angle(across):
    return np.unwrap(np.arctan2(-across[:, 2], across[:, 0]))


def turn_about_y(vectors, angles):
    out = vectors.copy()
    c, s = np.cos(angles).reshape(-1, 1), np.sin(angles).reshape(-1, 1)
    out[:, :, 0] = c * vectors[:, :, 0] + s * vectors[:, :, 2]
    out[:, :, 2] = -s * vectors[:, :, 0] + c * vectors[:, :, 2]
    return out


def to_features(positions, theta):
    frames = len(positions)
    out = np.zeros((frames, 63))
    for f in range(frames):
        h = positions[f, 0] * np.array([1, 0, 1])
        out[f, :60] = turn_about_y((positions[f] - h)[None], -theta[f : f + 1]).ravel()
        if f + 1 < frames:
            step = (positions[f + 1, 0] - positions[f, 0])[None, None]
            step = turn_about_y(step, -theta[f : f + 1])[0, 0]
            out[f, 60:] = step[0], step[2], theta[f + 1] - theta[f]
    out[-1, 60:] = out[-2, 60:]
    return out


def from_features(features, x, z, heading):
    place, angle = np.array([x, 0.0, z]), heading
    out = []
    for row in features:
        a = np.array([angle])
        out.append(turn_about_y(row[:60].reshape(1, 20, 3), a)[0] + place)
        place = place + turn_about_y(np.array([[[row[60], 0, row[61]]]]), a)[0, 0]
        angle = angle + row[62]
    return np.array(out)


def conv1d_by_loops(x, w, b):
    B, T, C = x.shape
    K, _, D = w.shape
    y = np.zeros((B, T, D)) + b
    for t in range(T):
        for k in range(K):
            s = t + k - K // 2
            if s < 0 or s >= T:
                continue
            y[:, t] += x[:, s] @ w[k]
    return y


def unfold(x, taps):
    half = taps // 2
    p = np.pad(x, ((0, 0), (half, half), (0, 0)))
    return np.stack([p[:, t : t + taps].reshape(len(x), -1) for t in range(x.shape[1])], axis=1)


def transpose_filters(w):
    return np.swapaxes(w[::-1], 1, 2), lambda dw: np.swapaxes(dw, 1, 2)[::-1]


def conv1d(x, w, b):
    K, T = w.shape[0], x.shape[1]
    p = np.pad(x, ((0, 0), (K // 2, K // 2), (0, 0)))
    rows = np.stack([p[:, k : k + T] for k in range(K)], axis=2)
    y = np.einsum("btkc,kcd->btd", rows, w) + b

    def back(dy):
        drows = np.einsum("btd,kcd->btkc", dy, w)
        dp = np.zeros_like(p, dtype=drows.dtype)
        for k in range(K):
            dp[:, k : k + T] += drows[:, :, k]
        return dp[:, K // 2 : K // 2 + T], np.einsum("btkc,btd->kcd", rows, dy), dy.sum((0, 1))

    return y, back


def max_pool(x):
    a, b = x[:, ::2], x[:, 1::2]
    first = a >= b

    def back(dy):
        dx = np.zeros_like(x)
        dx[:, ::2] = first * dy
        dx[:, 1::2] = (~first) * dy
        return dx

    return np.maximum(a, b), back


def unpool_even(y):
    return y.repeat(2, axis=1) / 2, lambda dx: (dx[:, ::2] + dx[:, 1::2]) / 2


def unpool_random(y, first):
    pairs = np.stack([y * first, y * ~first], axis=2)
    return pairs.reshape(
        len(y), -1, y.shape[2]
    ), lambda dx: dx[:, ::2] * first + dx[:, 1::2] * ~first


def pooled_again(y, first):
    return np.where(y > 0, y, 0)


def tanh(x):
    y = np.tanh(x)
    return y, lambda dy: (1 - y**2) * dy


def encode_layer(x, w, b):
    a, back_a = conv1d(x, w, b)
    p, back_p = max_pool(a)
    y = np.tanh(p)
    return y, lambda dy: back_a(back_p(dy * (1 - y * y)))


def arctanh(y, bound):
    c = np.minimum(np.maximum(y, -bound), bound)
    return np.arctanh(c), lambda dx: np.where((y >= -bound) & (y <= bound), dx / (1 - c**2), 0)


def decode_layer(y, w, b, bound):
    h, back_h = arctanh(y, bound)
    u, back_u = unpool_even(h)
    wt, back_w = transpose_filters(w)
    x, back_x = conv1d(u - b, wt, np.zeros_like(w[0, :, 0]))

    def back(dx):
        du, dwt, _ = back_x(dx)
        return back_h(back_u(du)), back_w(dwt), -np.sum(du, axis=(0, 1))

    return x, back


def project_layer(x, w, b, bound):
    y, up = encode_layer(x, w, b)
    x_hat, down = decode_layer(y, w, b, bound)

    def back(d):
        dy, *of_decoder = down(d)
        dx, *of_encoder = up(dy)
        return (dx, *[one + other for one, other in zip(of_encoder, of_decoder)])

    return x_hat, back


def mean_squared_error(x_hat, x):
    d = x_hat - x

    def pullback(dloss=1.0):
        return dloss * 2 * d / d.size

    return (d**2).mean(), pullback


def mean_absolute(y):
    return np.abs(y).mean(), lambda dloss=1.0: dloss * np.sign(y) / y.size


def zero_values(x, p, draws):
    out = x.copy()
    out[draws < p] = 0
    return out


def layer_loss(x, corrupted, w, b, first, alpha, bound):
    y, up = encode_layer(corrupted, w, b)
    h, back_h = arctanh(y, bound)
    u, back_u = unpool_random(h, first)
    wt, back_w = transpose_filters(w)
    x_hat, back_x = conv1d(u - b, wt, np.zeros(w.shape[1]))
    error = np.mean((x_hat - x) ** 2)
    sparse = np.mean(np.abs(y))
    du, dwt, _ = back_x(2 * (x_hat - x) / x.size)
    dy = back_h(back_u(du)) + alpha * np.sign(y) / y.size
    _, dw, db = up(dy)
    return error + alpha * sparse, dw + back_w(dwt), db - du.sum(axis=(0, 1))


def sgd_step(parameter, gradient, rate, decay, epoch):
    for _ in range(epoch):
        rate = rate * decay
    return parameter - rate * gradient


def train_layer(windows, w, b, loss, epochs, batch, rate, decay, p, rng):
    weights, losses = [], []
    for epoch in range(epochs):
        shuffled = windows[rng.permutation(len(windows))]
        total = []
        i = 0
        while i < len(windows):
            x = shuffled[i : i + batch]
            value, dw, db = loss(x, zero_values(x, p, rng.random(x.shape)), w, b)
            w = w - rate * decay**epoch * dw
            b = b - rate * decay**epoch * db
            total.append(value)
            i += batch
        weights.append((w, b))
        losses.append(sum(total) / len(total))
    return weights, losses


def frames_seen(taps, layers):
    if layers == 0:
        return 1
    return 2 * frames_seen(taps, layers - 1) + taps - 1


def stage_inputs(x, layers):
    out = []
    for w, b in layers:
        out.append(x)
        x, _ = encode_layer(x, w, b)
    return out


def stack_loss(x, corrupted, layers, bound):
    if not layers:
        return None
    hidden, ups = [corrupted], []
    for w, b in layers:
        y, back = encode_layer(hidden[-1], w, b)
        hidden.append(y)
        ups.append(back)
    out, downs = hidden[-1], [None] * len(layers)
    for i in range(len(layers) - 1, -1, -1):
        out, downs[i] = decode_layer(out, layers[i][0], layers[i][1], bound)
    loss, back = mean_squared_error(out, x)
    d, dw, db = back(), {}, {}
    for i in range(len(layers)):
        d, dw[i], db[i] = downs[i](d)
    for i in reversed(range(len(layers))):
        d, a, c = ups[i](d)
        dw[i], db[i] = dw[i] + a, db[i] + c
    return loss, [(dw[i], db[i]) for i in range(len(layers))]


def momentum_step(parameter, velocity, gradient, rate, momentum):
    new = np.multiply(momentum, velocity)
    new = new - gradient * rate
    return [np.add(parameter, new), new]


def adam_step(parameter, mean, square, gradient, rate, step):
    b1, b2 = 0.9, 0.99
    m = mean + (1 - b1) * (gradient - mean)
    v = square + (1 - b2) * (gradient * gradient - square)
    m_hat, v_hat = m / (1 - b1**step), v / (1 - b2**step)
    return parameter - rate * m_hat / (v_hat**0.5 + 1e-8), m, v


def one_cycle(peak, share):
    low, high, s = (1 / 25, 1, share / 0.3) if share < 0.3 else (1, 0, (share - 0.3) / 0.7)
    return peak * (high + (low - high) * (1 + np.cos(np.pi * s)) / 2)


def rescale(x):
    out = np.empty_like(x)
    for i, window in enumerate(x):
        moving = (window != 0).any(axis=0)
        share = np.mean(window[:, moving] != 0) if moving.any() else 1.0
        out[i] = window / share
    return out


def denoising_weights(second, cross, kept):
    n = len(second)
    m = np.array(
        [[second[i, j] * (kept if i == j else kept * kept) for j in range(n)] for i in range(n)]
    )
    return np.linalg.inv(m) @ (kept * cross)


def complete(x, known, project, interpolate, rounds):
    out = interpolate(x, known)
    while rounds:
        p = project(out)
        out = p + interpolate(x - p, known)
        out[known] = x[known]
        rounds -= 1
    return out


def hidden_from_visible(visible, hidden, complete, ridge):
    there = np.flatnonzero(complete)
    X, Y = visible[there], hidden[there]
    mx, my = X.mean(0), Y.mean(0)
    u, s, vt = np.linalg.svd(X - mx, full_matrices=False)
    keep = s / (s**2 + ridge * np.sum(s**2))
    B = vt.T @ (keep[:, None] * (u.T @ (Y - my)))
    return np.array([my + (row - mx) @ B for row in visible])


def G(y_0, y_1):
    total = 0.0
    for k in range(y_0.shape[1]):
        total += (max(y_0[:, k]) - max(y_1[:, k])) ** 2
        total += (min(y_0[:, k]) - min(y_1[:, k])) ** 2
    return total


def average_precision(distances, alike):
    found, total = 0, 0.0
    for rank, i in enumerate(np.argsort(distances), 1):
        if alike[i]:
            found += 1
            total += found / rank
    return total / found


def norms_through_time(pull, dh, frames):
    norms = [np.sqrt((dh**2).sum())]
    for t in reversed(range(1, frames + 1)):
        dh = pull(t, dh)
        norms.append(np.sqrt((dh**2).sum()))
    return np.array(norms[::-1])


def gate_gradients(dh_next, h, r, z, n, s_n):
    inner = dh_next * (1 - z) * (1 - n) * (1 + n)
    return inner * s_n * (r - r**2), dh_next * (h - n) * (z - z**2), inner, r * inner


def gru_step(x, h, w, u, b, c):
    H = h.shape[1]
    a, s = x @ w + b, h @ u + c
    r, _ = sigmoid(a[:, :H] + s[:, :H])
    z, _ = sigmoid(a[:, H : 2 * H] + s[:, H : 2 * H])
    n = np.tanh(a[:, 2 * H :] + r * s[:, 2 * H :])

    def back(d):
        dn = d * (1 - z) * (1 - n**2)
        dz = d * (h - n) * z * (1 - z)
        dr = dn * s[:, 2 * H :] * r * (1 - r)
        da, ds = np.hstack([dr, dz, dn]), np.hstack([dr, dz, dn * r])
        return da @ w.T, d * z + ds @ u.T, x.T @ da, h.T @ ds, da.sum(0), ds.sum(0)

    return (1 - z) * n + z * h, back


def gru(x, h0, w, u, b, c):
    h, ys, backs = h0, [], []
    for frame in np.moveaxis(x, 1, 0):
        h, back = gru_step(frame, h, w, u, b, c)
        ys.append(h)
        backs.append(back)

    def pullback(dy):
        dxs, dh, sums = [], 0, [0, 0, 0, 0]
        for back, d in zip(backs[::-1], np.moveaxis(dy, 1, 0)[::-1]):
            dx, dh, *rest = back(d + dh)
            dxs.insert(0, dx)
            sums = [one + other for one, other in zip(sums, rest)]
        return np.stack(dxs, 1), dh, *sums

    return np.stack(ys, 1), pullback


def clip_gradients(gradients, bound):
    norm = np.linalg.norm(np.concatenate([g.ravel() for g in gradients]))
    if norm <= bound:
        return gradients, norm
    return [g * bound / norm for g in gradients], norm


def read_clips(weights, x):
    h0 = np.zeros_like(x[:, 0] @ weights["encoder_w"][:, : len(weights["encoder_u"])])
    y, back = gru(x, h0, *[weights["encoder_" + k] for k in "wubc"])
    z = y[:, -1] @ weights["latent_w"] + weights["latent_b"]

    def pullback(dz):
        dy = np.zeros_like(y)
        dy[:, -1] = dz @ weights["latent_w"].T
        grads = dict(zip(["encoder_w", "encoder_u", "encoder_b", "encoder_c"], back(dy)[2:]))
        grads["latent_w"], grads["latent_b"] = y[:, -1].T @ dz, dz.sum(axis=0)
        return grads

    return z, pullback


def self_fed(h, frames, w, u, b, c, frame_w, frame_b):
    x, tape, ys = np.zeros((len(h), frame_w.shape[1]), h.dtype), [], []
    for _ in range(frames):
        h, back = gru_step(x, h, w, u, b, c)
        x = h @ frame_w + frame_b
        tape.append((h, back))
        ys.append(x)

    def pullback(dy):
        sums, dx, dh = [0, 0, 0, 0, 0, 0], 0, 0
        for t in range(frames - 1, -1, -1):
            state, back = tape[t]
            d = dy[:, t] + dx
            dx, dh, *rest = back(dh + d @ frame_w.T)
            rest += [state.T @ d, d.sum(0)]
            sums = [p + q for p, q in zip(sums, rest)]
        return dh, *sums

    return np.stack(ys, 1), pullback


def write_clips(weights, z, frames):
    keys = ("decoder_w", "decoder_u", "decoder_b", "decoder_c", "frame_w", "frame_b")
    y, back = self_fed(z @ weights["state_w"] + weights["state_b"], frames, *map(weights.get, keys))

    def pullback(d):
        dh, *rest = back(np.flip(d, axis=1))
        grads = {"state_w": z.T @ dh, "state_b": np.sum(dh, axis=0)}
        grads.update(zip(keys, rest))
        return dh @ weights["state_w"].T, grads

    return np.flip(y, axis=1), pullback


def reconstruction_loss(weights, x):
    z, back_z = read_clips(weights, x)
    x_hat, back_x = write_clips(weights, z, len(x[0]))
    dz, grads = back_x(2 * (x_hat - x) / x.size)
    grads.update(back_z(dz))
    return np.mean((x_hat - x) ** 2), grads


def wasserstein_1d(p, q):
    i, j = np.argsort(p), np.argsort(q)
    partner = np.empty_like(p)
    partner[i] = q[j]
    return np.mean((p - partner) ** 2), lambda dloss=1.0: dloss * 2 * (p - partner) / len(p)


def sliced_wasserstein(z, prior, directions):
    loss, dz = 0.0, np.zeros_like(z)
    for theta in directions:
        one, back = wasserstein_1d(z @ theta, prior @ theta)
        loss = loss + one / len(directions)
        dz += back()[:, None] * theta / len(directions)
    return loss, lambda dloss=1.0: dloss * dz


def regularised_loss(weights, x, prior, directions, weight):
    z, back_z = read_clips(weights, x)
    x_hat, back_x = write_clips(weights, z, x.shape[1])
    error, back_e = mean_squared_error(x_hat, x)
    far, back_f = sliced_wasserstein(z, prior, directions)
    dz, grads = back_x(back_e(1.0))
    for name, gradient in back_z(dz + weight * back_f()).items():
        grads[name] = gradient
    return error + weight * far, grads


def central_differences(f, x, h):
    out = np.zeros_like(x)
    flat, slopes = x.ravel(), out.ravel()
    for i in range(x.size):
        up, down = flat.copy(), flat.copy()
        up[i] += h
        down[i] -= h
        slopes[i] = (f(up.reshape(x.shape)) - f(down.reshape(x.shape))) / (2 * h)
    return slopes.reshape(x.shape)


def adjoint_gap(f, x, y):
    value, back = f(x)
    g = back(y)
    n = np.linalg.norm
    return np.abs((value * y).sum() - (x * g).sum()) / (n(value) * n(y) + n(x) * n(g))


def accuse(suspect):
    return [
        "adjoint in x",
        "gradient for y",
        "gradient for b",
        "gradient for c",
        "gradient for h0",
        "linearity",
    ][suspect - 1]


def check_gradients(f, inputs):
    names, arrays = list(inputs), list(inputs.values())
    value, back = f(*arrays)
    dy = np.random.default_rng(3).normal(size=np.shape(value))
    got = back(dy)
    got = got if isinstance(got, tuple) else (got,)
    for k, name in enumerate(names):
        h = 1e-5 * max(1e-9, np.abs(arrays[k]).max())
        right = central_differences(
            lambda a: np.sum(dy * f(*arrays[:k], a, *arrays[k + 1 :])[0]), arrays[k], h
        )
        scale = np.abs(right).max() + np.abs(got[k]).max()
        if not np.all(np.abs(got[k] - right) <= 1e-6 * scale):
            raise AssertionError(f"{name}: gradient wrong")


def three_products(a, b, p, q, multiply):
    ap, bq = multiply(a, p), multiply(b, q)
    return ap - bq, multiply(a + b, p + q) - ap - bq


def one_frequency(frequency, taps, frames):
    n = taps + frames - 1
    t = np.arange(n)
    c, s = np.cos(2 * np.pi * frequency * t / n), np.sin(2 * np.pi * frequency * t / n)
    if frequency == 0 or 2 * frequency == n:
        return c.reshape(1, n), c[:taps].reshape(1, taps), c[:frames].reshape(frames, 1) / n
    gr, gi = c[:taps], s[:taps]
    C = [2 / n * (c[:frames] + s[:frames]), 2 / n * (s[:frames] - c[:frames]), -2 / n * s[:frames]]
    return np.array([c, -s, c - s]), np.array([gr, gi, gr + gi]), np.array(C).T


def block_matrices(taps, frames):
    n = taps + frames - 1
    A, G, C = [], [], []
    t = np.arange(n)
    for f in range(n // 2 + 1):
        c, s = np.cos(2 * np.pi * f * t / n), np.sin(2 * np.pi * f * t / n)
        if f == 0 or 2 * f == n:
            A, G, C = A + [c], G + [c[:taps]], C + [c[:frames] / n]
            continue
        gr, gi = c[:taps], s[:taps]
        A += [c, -s, c - s]
        G += [gr, gi, gr + gi]
        C += [
            2 / n * (c[:frames] + s[:frames]),
            2 / n * (s[:frames] - c[:frames]),
            -2 / n * s[:frames],
        ]
    return np.array(A), np.array(G), np.array(C).T


def conv1d_by_blocks(x, w, b, a, g, c):
    (B, T, C), K, L = x.shape, len(w), len(c)
    N = -(-T // L)
    p = np.pad(x, ((0, 0), (K // 2, N * L - T + K // 2), (0, 0)))
    blocks = np.stack([p[:, i * L : i * L + a.shape[1]] for i in range(N)], axis=1)
    u = np.einsum("sp,bnpc->bnsc", a, blocks)
    v = np.einsum("sk,kcd->scd", g, w)
    y = np.einsum("ls,bnsc,scd->bnld", c, u, v).reshape(B, N * L, -1)[:, :T] + b

    def back(dy):
        d = np.pad(dy, ((0, 0), (0, N * L - T), (0, 0))).reshape(B, N, L, -1)
        m = np.einsum("ls,bnld->bnsd", c, d)
        dw = np.einsum("sk,bnsc,bnsd->kcd", g, u, m)
        db = np.einsum("sp,bnsd,scd->bnpc", a, m, v)
        dp = np.zeros(p.shape)
        for i in range(N):
            dp[:, i * L : i * L + a.shape[1]] += db[:, i]
        return dp[:, K // 2 : K // 2 + T].astype(x.dtype), dw.astype(w.dtype), dy.sum(axis=(0, 1))

    return y.astype(x.dtype), back


def bones_off(q, lengths, parents):
    pairs = [(j, p) for j, p in enumerate(parents) if p >= 0]
    n = len(pairs) * len(q)
    loss, slope = 0.0, np.zeros_like(q)
    for j, p in pairs:
        bone = q[:, j] - q[:, p]
        length = np.sqrt((bone**2).sum(axis=1))
        loss += np.sum((length - lengths[j]) ** 2) / n
        d = (2 * (length - lengths[j]) / n / length)[:, None] * bone
        slope[:, j] += d
        slope[:, p] -= d
    return loss, lambda dloss=1.0: dloss * slope


def path_energy(path):
    n = len(path) - 1

    def back(dloss=1.0):
        d = np.zeros_like(path)
        for i in range(n):
            d[i + 1] += 2 * n * dloss * (path[i + 1] - path[i])
            d[i] -= 2 * n * dloss * (path[i + 1] - path[i])
        return d

    return n * sum(np.sum((path[i + 1] - path[i]) ** 2) for i in range(n)), back


def observed_error(x_hat, x, known):
    d = x_hat[known] - x[known]

    def back(dloss=1.0):
        g = np.zeros_like(x_hat)
        g[known] = dloss * 2 * d / d.size
        return g

    return np.mean(d**2), back
