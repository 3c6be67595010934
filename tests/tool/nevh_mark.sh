#!/bin/sh
# nevh mark: answers as people type them, and tables as spreadsheets save them.

. "${srcdir:-.}/tests/support/nevh_support.sh"
. "$srcdir/tests/python/find_python.sh"
PYTHON=$python
export PYTHON
PYTHONPATH=$srcdir/python
export PYTHONPATH

# One number in many hands; what follows is none.
"$python" - <<'END' || fails "reads answers wrongly"
import math
from nevh._hand_in import typed
right = {
    ("", 2.3e-4): ("0.00023", "0,00023", "2.3e-4", "2,3e-4", " 2.3 E\u221204 ", "2.3x10^-4",
                   "2.3\u00d710\u207b\u2074", "2,3 \u00b7 10\u22124", "2.3*10^(-4)", "2.3 10^-4",
                   "$2.3\\cdot10^{-4}$", "err = 2.3e-4", "\u2248 2.3e-4", "about 2.3e-4", "'2.3e-4",
                   "0.023 %", "0,023%", "2.3e-4 \u00b1 1e-5", "2.3e-4 (rounded)"),
    ("", -0.5): ("-0.5", "\u2212.5", "\u20130,5", "- 0.5", "minus 0.5", "-1/2"),
    ("", 1e-4): ("10^-4", "1e-4"),
    ("s", 1.5): ("1.5 s", "1,5s", "1.5\u00a0s", "1500 ms", "0.025 min", "3/2 s"),
    ("s", 2219.5): ("2219.5", "2 219,5", "2\u202f219.5 s", "2'219.5", "2,219.5", "2.219,5"),
    ("rad", 0.5): ("0.5", "0.5 rad", "\uff10.\uff15", "0.50(1)"),
    ("rad", math.pi/6): ("30\u00b0", "30 deg", "pi/6", "\u03c0/6"),
    ("rad/s", 2*math.pi): ("1 Hz", "1.0 hertz", "360 \u00b0/s"),
    ("rad/s", 45.1): ("45.1", "45.1 rad/s", "45.1 1/s"),
    ("s", 1500.0): ("1.5 ks",),
    ("1/s", 44.3): ("44.3 1/s", "44.3 s^-1", "44,3 s\u207b\u00b9", "44.3 rad/s"),
    ("%", 7.6): ("7.6", "7.6 %"),
}
for (unit, number), texts in right.items():
    for text in texts:
        made = typed(text, unit).number
        assert made is not None and math.isclose(made, number, rel_tol=1e-12), (text, made)
for text in ("1e999", "1e99999999", "1.2.3", "1 or 2", "0.1 - 0.2", "nan", "0x10", "2.3*10",
             "01.02.2026", "1. Feb", "2-Jan", "#NAME?", "<0.01", "1/0", "2 1/2", "1,2,3"):
    assert typed(text).number is None and typed(text).why, text
assert typed("2,219", "s").number == 2.219 and typed("2,219", "s").other.number == 2219
END

# The same answers in the encodings and forms of spreadsheets.
printf '%s\n' 'José Núñez' 'Ada Lovelace' >$work/names
exits 0 sheet 8 --for $work/names --key 7 --answers --format csv
ratio() { awk -F, -v name="$1" '$1 == name { print $3 }' $work/answers; }
cp $work/out $work/answers
one=$(ratio 'José Núñez') two=$(ratio 'Ada Lovelace')
comma=$(echo $one | tr . ,)
all_right() { # FILE [OPTION...]
    file=$1
    shift
    exits 0 mark $file --key 7 "$@"
    test "$(grep -c ': 1 of 1 are right' $work/out)" = 2 || { cat $work/out; fails "refuses $file"; }
}
printf 'name,task,answer\nJosé Núñez,8.1,%s\nAda Lovelace,8.1,%s\n' $one $two >$work/plain.csv
all_right $work/plain.csv
# Too few digits are of a right answer, not of any short one.
awk -v x=$one 'BEGIN { printf "%.2g", x }' >$work/short
awk -v x=$one 'BEGIN { printf "%.2g", x*1.4 }' >$work/false
for answer in short false; do
    printf 'name,task,answer\nJosé Núñez,8.1,%s\n' $(cat $work/$answer) >$work/$answer.csv
    exits 0 mark $work/$answer.csv --key 7
    cp $work/out $work/$answer.out
done
grep -q 'too few digits' $work/short.out || { fails "does not say why"; cat $work/short.out; }
grep -q 'too few digits' $work/false.out && fails "says that a false answer has too few digits"
{ printf '\357\273\277'; sed 's/$/\r/' $work/plain.csv; } >$work/bom.csv
all_right $work/bom.csv
printf 'sep=;\r\nName;Task;Answer;\r\nJosé Núñez;Task 8.1;%s;\r\nAda Lovelace;8,1;%s;;\r\n' $comma $two >$work/semicolon.csv
all_right $work/semicolon.csv
for code in UTF-16 UTF-16LE WINDOWS-1252; do
    iconv -f UTF-8 -t $code $work/semicolon.csv >$work/$code.csv 2>/dev/null || continue
    all_right $work/$code.csv
done
printf 'Surname\tFirst name\tE-mail\t8.1 factor (3 digits)\nNúñez\tJosé\ta@b.c\t%s\nLovelace\tAda\t\t%s\n' $comma $two >$work/wide.csv
all_right $work/wide.csv
printf 'name,task,answer\nJosé Núñez,8.1,%s\nAda Lovelace,8.1,%s\n' $comma $two >$work/comma.csv
all_right $work/comma.csv
printf 'student,question,response\n"Nunez, Jose",8.1,%s\n"LOVELACE,  Ada",8.1,%s\n' $one $two >$work/turned.csv
all_right $work/turned.csv --for $work/names
# A class list of a spreadsheet names the same people.
printf 'Nr;Surname;First name\r\n1;Núñez;José\r\n2;Lovelace;Ada\r\n' |
    iconv -f UTF-8 -t WINDOWS-1252 >$work/list.csv
all_right $work/plain.csv --for $work/list.csv
# The form is filled in, here by nobody.
exits 0 sheet 8 --for $work/names --as form -o $work/form.csv
exits 0 mark $work/form.csv --for $work/names --key 7
test "$(grep -c 'missing' $work/out)" = 2 || fails "does not read its own form"
test "$(grep -c ': 0 of 1 are right' $work/out)" = 2 || fails "does not count who is missing"

# Spreadsheets compute no name of a form, and it is that name when it comes back.
printf '=1+1\n@Lovelace\n-2\n' >$work/computed
exits 0 sheet 8 --for $work/computed --as form -o $work/form.csv
cut -c1-3 $work/form.csv >$work/begin
test "$(sed 1d $work/begin | tr '\n' ' ')" = "'=1 '@L -2 " ||
    fails "a spreadsheet computes names: $(cat $work/form.csv)"
exits 0 mark $work/form.csv --for $work/computed --key 7
test "$(grep -c ': 0 of 1 are right' $work/out)" = 3 || fails "does not find its own names"
has '^=1\+1'

# Names that are not in the list, rows without one, and tasks that are none: all at once.
printf 'name,task,answer\nJosé Núñez,8.1,1\nAda Lovelase,8.1,1\n,8.1,1\nAda Lovelace,8.7,1\n' >$work/bad.csv
exits 2 mark $work/bad.csv --for $work/names --key 7
says 'line 3: Ada Lovelase is not in the list of names; Ada Lovelace is'
says 'line 4: there is no name'
says 'line 5: there is no task 8.7'
exits 2 mark $work/bad.csv --key 7
says 'line 4: there is no name'
# An answer that is given twice counts once, the last.
printf 'name,task,answer\nAda Lovelace,8.1,1\nAda Lovelace,8.1,%s\n' $two >$work/twice.csv
exits 0 mark $work/twice.csv --key 7
has 'Ada Lovelace: 1 of 1 are right'
says 'line 3: Ada Lovelace answers 8.1 again'
printf 'PK\003\004' >$work/book.xlsx
exits 2 mark $work/book.xlsx
says 'save it as CSV'

# Pipes give names and answers; those that nobody writes to, and devices, have an end.
mkfifo $work/pipe && {
    printf 'name\nAda Lovelace\n' >$work/pipe &
    exits 0 sheet 8 --for $work/pipe --key 7 --as form
    has '^Ada Lovelace'
    cat $work/twice.csv >$work/pipe &
    exits 0 mark $work/pipe --key 7
    limit="${limit:+timeout 60}"
    exits 2 mark $work/pipe
    says 'nothing was written to this pipe'
}
exits 2 mark /dev/zero
says 'too large'
# A file that cannot be written whole is as it was.
echo kept >$work/form.csv
seq 100 | sed 's/^/Somebody with a name of some length /' >$work/many
(
    ulimit -f 1
    exits 2 sheet 8 --for $work/many --key 7 --as form -o $work/form.csv
    says 'form.csv cannot be written'
    exit $status
) || status=1
test "$(cat $work/form.csv; ls $work | grep -c 'form.csv.')" = "kept
0" || fails "leaves a part of a file"

# Without a key all have the usual sheet; a sheet for a name needs one.
usual=$("$nevh" sheet 8 --answers --format csv | sed -n 2p | cut -d, -f3)
printf 'name,task,answer\nAda Lovelace,8.1,%s\nJosé Núñez,8.1,%s\n' $usual $usual >$work/usual.csv
exits 0 mark $work/usual.csv
test "$(grep -c ': 1 of 1 are right' $work/out)" = 2 || fails "refuses the usual answers"
exits 2 sheet 8 --for 'Ada Lovelace'
says '--for needs --key'
for name in A B C D; do echo $name,8.1,-1; done | sed '1i name,task,answer' >$work/wrong.csv
exits 0 mark $work/wrong.csv
says '0 of 4 answers are right; if the sheets were made with --key'

# Names that differ in an accent have a file each.
printf 'Nuñez\nNunez\nNUÑEZ J.\nNunez-J\n' >$work/alike
exits 0 sheet 8 --for $work/alike --key 7 --as page -o $work/alike.d
test "$(ls $work/alike.d | wc -l)" = 4 || fails "writes two sheets to one file"

# All sheets on one page to print.
exits 0 sheet 8 --for $work/names --key 7 -o $work/class.html
test "$(grep -c '<section class="sheet">' $work/class.html)" = 2 || fails "has not a sheet a name"
exit $status
