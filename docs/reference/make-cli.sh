#!/usr/bin/env bash
# Writes docs/reference/cli.md from the help texts of the program: make-cli.sh [PROGRAM].
# Without an argument, PROGRAM is target/release/abbe.
set -euo pipefail
folder=$(cd "$(dirname "$0")" && pwd)
program=$(realpath "${1:-$folder/../../target/release/abbe}")
cd "$folder"
export COLUMNS=100

# The help texts contain the name of the program's file, which must be `abbe`.
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
ln -s "$program" "$scratch/abbe"
abbe=$scratch/abbe

page() {
  cat <<'HEAD'
# Command line

This page holds the help text of every command. `docs/reference/make-cli.sh` generates it.

- Results go to standard output. Errors, notes and progress go to standard error.
- The exit status is explained in [files](files.md#exit-status).
- Files are written under a temporary name and renamed when they are complete.
- A scene may name files only in its own folder and below. `--allow-outside` lifts this limit.

HEAD
  commands=$("$abbe" --help | sed -n '/^Commands:/,/^Options:/p' | grep -oE '^  [a-z]+' | tr -d ' ' | grep -v '^help$')
  printf '## abbe\n\n```text\n'
  "$abbe" --help
  printf '```\n'
  for command in $commands; do
    printf '\n## abbe %s\n\n```text\n' "$command"
    "$abbe" "$command" --help
    printf '```\n'
  done
}
page | sed 's/[[:space:]]*$//' > "$scratch/cli.md"
cp "$scratch/cli.md" cli.md
