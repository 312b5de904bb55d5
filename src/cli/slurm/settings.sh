
# Prints the file of a complete part: result PART PASSES.
result() {
  echo "parts/part-$1-of-$parts.$2.exr"
}

# Submits parts and the job that merges them: submit PARTS PASSES TRY.
submit() {
  local array merge
  array=$(sbatch --parsable --job-name="$name" --array="$1" --requeue --open-mode=append --signal=B:USR1@60 \
    --output=logs/part-%a.log --export="ALL,ABBE_PASSES=$2" "${sbatch_options[@]}" part.sh)
  merge=$(sbatch --parsable --job-name="$name-merge" --dependency="afterany:${array%%;*}" --requeue \
    --open-mode=append --output=logs/merge.log --export="ALL,ABBE_PASSES=$2,ABBE_TRY=$3" \
    "${sbatch_options[@]}" merge.sh)
  echo "submitted array job ${array%%;*} and merge job ${merge%%;*}"
}
