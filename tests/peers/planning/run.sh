#!/usr/bin/env bash
# Direct collocation beside our planners on the task of Table II. Needs python3 with venv, network access
# to PyPI on the first run, and Rust; keeps everything in target/. Arguments go to collocation.py.
set -euo pipefail
cd "$(dirname "$0")/../../.."
venv="target/venv"
plans="target/peers/planning"

if ! "$venv/bin/python" -c "import casadi, numpy" 2>/dev/null; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet casadi==3.8.2 numpy
fi

# Our plans and their times, with all optimisations.
cargo run --release --quiet -p shapebot-tests --example peer_plans -- "$plans"
PYTHONDONTWRITEBYTECODE=1 "$venv/bin/python" tests/peers/planning/collocation.py --plans "$plans" "$@"
