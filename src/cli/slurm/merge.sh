#!/bin/bash
# Merges the parts when the array job has ended. `abbe slurm` has written this file.
#
# If parts are missing, this job submits them again, and then itself. If the picture has not reached
# the target error, this job submits the next round.
set -euo pipefail
. ./settings.sh

passes=$ABBE_PASSES
missing=() files=()
for ((part = 0; part < parts; part++)); do
  file=$(result "$part" "$passes")
  files+=("$file")
  if [ ! -e "$file" ]; then missing+=("$part"); fi
done
if ((${#missing[@]} > 0)); then
  list=$(IFS=,; echo "${missing[*]}")
  if ((ABBE_TRY > retries)); then
    echo "parts $list are missing after $ABBE_TRY tries; the folder logs contains their messages" >&2
    exit 1
  fi
  echo "parts $list are missing, and are submitted again"
  submit "$list" "$passes" $((ABBE_TRY + 1))
  exit
fi

status=0
"$abbe" merge "${files[@]}" -o "$picture" --stats "${picture%.exr}.json" "${merge_options[@]}" || status=$?
# Exit status 3 means that the error is above the target.
if [ "$status" = 3 ] && ((limit == 0 || passes < limit)); then
  next=$(((passes * 3 / 2 + step - 1) / step * step))
  if ((limit > 0 && next > limit)); then next=$limit; fi
  echo "the next round has $next passes"
  submit "0-$((parts - 1))" "$next" 1
  exit
fi
exit "$status"
