#!/usr/bin/env bash
# Compiles every LaTeX table below a report folder in one document: scripts/compile-tables.sh REPORTS_DIR [OUT.pdf]
# Fails if a table does not compile, or does not fit an A4 page with margins of 25 mm. Needs pdflatex with adjustbox, booktabs, longtable, pdflscape
# and siunitx 3 (on Debian texlive-latex-extra and texlive-science).
set -euo pipefail

if (($# < 1 || $# > 2)); then
    echo "usage: $0 REPORTS_DIR [OUT.pdf]" >&2
    exit 2
fi
reports=$(cd "$1" && pwd)
out=${2:-}
command -v pdflatex >/dev/null || { echo "pdflatex is missing" >&2; exit 2; }
# Wider than the page by more than this [pt] is an error: the widths of text are estimates.
tolerance=10

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

mapfile -d '' tables < <(cd "$reports" && find . -name '*.tex' -print0 | LC_ALL=C sort -z)
((${#tables[@]} > 0)) || { echo "no .tex below $reports" >&2; exit 2; }

{
    echo '\documentclass[a4paper]{article}'
    echo '\usepackage[margin=25mm]{geometry}'
    echo '\usepackage{adjustbox,booktabs,longtable,pdflscape,siunitx}'
    echo '\begin{document}'
    for number in "${!tables[@]}"; do
        # Copies: TeX cannot read every path. The names go to the log, beside what it complains about.
        cp "$reports/${tables[$number]}" "$scratch/table$number.tex"
        printf '\\message{^^J== %s^^J}\n' "${tables[$number]#./}"
        printf '\\input{table%s}\n\\clearpage\n' "$number"
    done
    echo '\end{document}'
} >"$scratch/tables.tex"

compile() { (cd "$scratch" && max_print_line=1000 pdflatex -interaction=nonstopmode -halt-on-error tables.tex >tables.out 2>&1); }

# Widths of long tables need several runs; the log says when they have settled.
for run in 1 2 3 4 5; do
    if ! compile; then
        # The last name before the first error, and the error.
        awk '/^== /{name=$0} /^!/{print name; print; for (k = 0; k < 4 && getline; k++) print; exit}' "$scratch/tables.out" >&2
        echo "a table does not compile" >&2
        exit 1
    fi
    grep -q 'Rerun\|Table widths have changed' "$scratch/tables.log" || break
done

wide=$(awk -v most="$tolerance" '
    /^== /{name=substr($0, 4)}
    /^Overfull .hbox/{width=$0; sub(/.*\(/, "", width); sub(/pt too wide.*/, "", width); if (width + 0 > most && !seen[name]++) print name ": " width " pt too wide"}
' "$scratch/tables.log")
pages=$(sed -n 's/^Output written on tables.pdf (\([0-9]*\) page.*/\1/p' "$scratch/tables.log")
echo "${#tables[@]} tables, $pages pages"
[[ -z $out ]] || cp "$scratch/tables.pdf" "$out"
if [[ -n $wide ]]; then
    printf '%s\n' "$wide" >&2
    exit 1
fi
