#!/usr/bin/env bash
# Vector PDFs of all SVG figures below a report folder, each beside its SVG and of the same size on paper:
# scripts/figures-pdf.sh REPORTS_DIR [OUT_DIR]. With OUT_DIR the PDFs go there, in the same sub-folders.
# Needs rsvg-convert (on Debian librsvg2-bin) and a sans-serif font: Helvetica, Arial, Liberation Sans or DejaVu Sans.
set -euo pipefail

if (($# < 1 || $# > 2)); then
    echo "usage: $0 REPORTS_DIR [OUT_DIR]" >&2
    exit 2
fi
reports=${1%/}
out=${2:-$reports}
command -v rsvg-convert >/dev/null || { echo "rsvg-convert is missing" >&2; exit 2; }
[[ -d $reports ]] || { echo "no folder $reports" >&2; exit 2; }
if command -v fc-match >/dev/null && [[ -z $(fc-match -f '%{file}' sans-serif) ]]; then
    echo "no sans-serif font: the figures would have no text" >&2
    exit 2
fi

count=0 failed=0
while IFS= read -r -d '' figure; do
    name=${figure#"$reports"/}
    pdf=$out/${name%.svg}.pdf
    mkdir -p "$(dirname "$pdf")"
    # A half-written file would look like a figure. The time in the file is that of the numbers, not of today.
    if SOURCE_DATE_EPOCH=0 rsvg-convert --format=pdf --output="$pdf.partial" "$figure"; then
        mv "$pdf.partial" "$pdf"
        count=$((count + 1))
    else
        rm -f "$pdf.partial"
        echo "not converted: $figure" >&2
        failed=$((failed + 1))
    fi
done < <(find "$reports" -name '*.svg' -print0 | LC_ALL=C sort -z)
echo "$count figures as PDF below $out"
((count > 0 && failed == 0))
