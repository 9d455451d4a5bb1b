#!/usr/bin/env bash
# Gradescope runs this once, on the image "Ubuntu 24.04" (Python 3.12).
set -e
apt-get update
apt-get install -y python3-venv
python3 -m venv /autograder/venv
/autograder/venv/bin/pip install /autograder/source/numpy_cae-*.whl
