"""Progress: a line an epoch without tqdm, silence where asked."""

from numpy_cae.training.progress import Progress


def test_a_line_an_epoch_says_stage_loss_and_time(capsys):
    progress = Progress("layer 2", epochs=3, steps=5, bar=False)
    progress.step()
    progress.epoch(0, 0.125)
    progress.close()
    said = capsys.readouterr().err
    assert said.startswith("layer 2, epoch 1/3: loss 0.12500")
    assert "to go" in said
    assert said.count("\n") == 1


def test_a_bar_shows_the_loss(capsys):
    progress = Progress("fine tuning", epochs=2, steps=1)
    for epoch in range(2):
        progress.step()
        progress.epoch(epoch, 0.5 - epoch / 4)
    progress.close()
    said = capsys.readouterr().err
    assert "fine tuning" in said
    assert "loss 0.25000" in said


def test_silence(capsys):
    progress = Progress("layer 1", epochs=1, steps=1, shown=False)
    progress.step()
    progress.epoch(0, 1.0)
    progress.close()
    assert capsys.readouterr().err == ""
