#!/bin/bash
# Submits the render: an array job with one task for each part, and a job that merges the parts.
# `abbe slurm` has written this file.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")"
. ./settings.sh
mkdir -p parts logs
submit "0-$((parts - 1))" "$first" 1
