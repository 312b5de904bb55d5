#!/bin/bash
# Renders one part of the picture, as a task of an array job. `abbe slurm` has written this file.
#
# The task may be killed and started again at any time. It continues from its checkpoint, and it
# does nothing if the part is complete.
set -euo pipefail
. ./settings.sh

part=$SLURM_ARRAY_TASK_ID
passes=$ABBE_PASSES
result=$(result "$part" "$passes")
run=parts/run-$part-of-$parts
checkpoint=$run.checkpoint.exr

# Only one task at a time works on a part.
exec 9> "$run.lock"
flock 9
if [ -e "$result" ]; then
  echo "part $part is complete"
  exit
fi
# The part of an earlier round is the checkpoint of this round.
if [ ! -e "$checkpoint" ]; then
  for earlier in parts/part-"$part-of-$parts".*.exr; do
    if [ -e "$earlier" ]; then mv -f -- "$earlier" "$checkpoint"; fi
  done
fi
if [ -e "$checkpoint" ]; then echo "part $part continues from its checkpoint"; fi

"$abbe" render "$scene" "${render_options[@]}" --passes "$passes" --part "$part/$parts" -o "$run.exr" \
  --threads "${SLURM_CPUS_PER_TASK:-1}" --keep-checkpoint --quiet --resume auto 9>&- &
child=$!
# Slurm sends USR1 before the time limit. The task then saves its passes and queues itself again.
signalled='' again=''
trap 'signalled=yes again=yes; kill -TERM "$child"' USR1
trap 'signalled=yes; kill -TERM "$child"' TERM
status=0
while :; do
  status=0
  wait "$child" || status=$?
  if [ -z "$signalled" ]; then break; fi
  signalled=''
done
if [ "$status" = 130 ] && [ -n "$again" ]; then
  echo "the time limit is near; part $part is queued again"
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_$part"
  exit
fi
if [ "$status" != 0 ]; then exit "$status"; fi
mv -f -- "$run.exr" "$result"
rm -f -- "$checkpoint" "$run.png"
