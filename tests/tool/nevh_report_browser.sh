#!/bin/sh
# A report in browsers: what moves in it plays on demand, offline, without errors.

. "${srcdir:-.}/tests/support/nevh_support.sh"

exits 0 report pendulum -o $work/report.html
command="report in a browser"
in_browsers try_report.mjs "$PWD/$work/report.html"
exit $status
