#!/bin/bash
# Runs every fuzzer below FOLDER, in turn, for SECONDS all together; one line each. What a fuzzer found interesting is kept
# beside it for the next time; a file that broke something is named, with the end of the log.
# usage: run-fuzzers.sh FOLDER SECONDS
set -euo pipefail
folder=$1 seconds=$2

mapfile -t fuzzers < <(find "$folder" -name '*_fuzz' -type f -executable | sort)
((${#fuzzers[@]})) || { echo "run-fuzzers.sh: there are no fuzzers (*_fuzz) in $folder." >&2; exit 1; }
each=$((seconds / ${#fuzzers[@]}))
((each > 0)) || each=1 # 0 would mean for ever

# What a fuzzer starts from: the small scenes, the good ones and the bad ones, and small files of data.
seeds=$(find scenes tests/bad_input src/formats/tests/seeds -type f -size -64k | sort | paste -sd,)

for fuzzer in "${fuzzers[@]}"; do
  name=$(basename "$fuzzer")
  corpus=$fuzzer.corpus log=$fuzzer.log
  mkdir -p "$corpus"
  if "$fuzzer" -max_total_time="$each" -timeout=10 -rss_limit_mb=2048 -artifact_prefix="$fuzzer.found-" \
    -seed_inputs="$seeds" "$corpus" >"$log" 2>&1; then
    echo "$name: $(grep -oP '^Done \K\d+' "$log") inputs in $each s, nothing found"
  else
    tail -n 30 "$log"
    echo "$name: FAILED; see $fuzzer.found-* and $log" >&2
    exit 1
  fi
done
