#!/bin/sh
# Asks every question of a file of findings, one statement each, of a lineage: ask.sh QUESTIONS.sql LINEAGE.db
# The program is $HATCHERY, or `hatchery` on the path.
set -eu
[ $# -eq 2 ] || { echo "usage: $0 QUESTIONS.sql LINEAGE.db" >&2; exit 2; }
hatchery=${HATCHERY:-hatchery}
statement=
while IFS= read -r line || [ -n "$line" ]; do
    case $line in
    '-- '*) [ -n "$statement" ] || echo "${line#-- }"; continue ;;
    *';') statement="$statement $line"
        "$hatchery" sql "${statement%;}" --db "$2"
        echo
        statement= ;;
    '') ;;
    *) statement="$statement $line" ;;
    esac
done < "$1"
