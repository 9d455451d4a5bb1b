"""The solutions of lesson 07, going deep."""

from numpy_cae.course.solutions.lesson_05 import decode_layer, encode_layer
from numpy_cae.ops import mean_squared_error


def frames_seen(taps, layers):
    """The number of input frames that one hidden frame of the top layer depends on."""
    frames = 1
    for _ in range(layers):
        frames = 2 * frames + taps - 1
    return frames


def stage_inputs(x, layers):
    """The clean input that each layer learns to reproduce, lowest first."""
    inputs = [x]
    for w, b in layers[:-1]:
        y, _ = encode_layer(inputs[-1], w, b)
        inputs.append(y)
    return inputs


def stack_loss(x, corrupted, layers, bound):
    """The mean squared error of the whole stack, and its gradients layer by layer."""
    y = corrupted
    up_backs = []
    for w, b in layers:
        y, back = encode_layer(y, w, b)
        up_backs.append(back)
    x_hat = y
    down_backs = []
    for w, b in reversed(layers):
        x_hat, back = decode_layer(x_hat, w, b, bound)
        down_backs.append(back)
    loss, loss_back = mean_squared_error(x_hat, x)

    d = loss_back()
    down = []
    for back in reversed(down_backs):
        d, dw, db = back(d)
        down.append((dw, db))  # the lowest layer was decoded last and comes first here
    up = []
    for back in reversed(up_backs):
        d, dw, db = back(d)
        up.append((dw, db))
    up.reverse()
    gradients = [(dw1 + dw2, db1 + db2) for (dw1, db1), (dw2, db2) in zip(up, down, strict=True)]
    return loss, gradients
