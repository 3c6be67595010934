#!/bin/sh
# nevh sheet and nevh mark: other numbers for each name, and answers that are marked.

. "${srcdir:-.}/tests/support/nevh_support.sh"
. "$srcdir/tests/python/find_python.sh"
PYTHON=$python
export PYTHON
NEVH_COMMAND=$(CDPATH= cd "$(dirname "$nevh")" && pwd)/$(basename "$nevh")

exits 0 sheet
has 'Who keeps the energy'
cp $work/out $work/list
exits 0 sheets
cmp -s $work/out $work/list || fails "differs from nevh sheet"
exits 2 sheet 99
says 'there is no sheet 99'
exits 2 sheet one
exits 2 sheet 1 --as paper
says 'page, notebook, check, moodle or form'

exits 2 sheet 1 --as check -o $work/check.html
says 'made in a folder: -o .*/check$'
exits 2 sheet 1 --as notebook -o $work/sheet.ipynb
test -e $work/check.html -o -e $work/sheet.ipynb && fails "makes a folder of a file's name"

# Without a name the usual numbers.
exits 0 sheet 1 -o $work/usual
for text in 'from phi = 2, p = 0, dt = 0.05' 'nevh run pendulum --integrators euler --dt 0.05'; do
    grep -q "$text" $work/usual/sheet-1.html || fails "lacks '$text'"
done
cmp -s $work/usual/sheet-1.ipynb "$srcdir/python/sheets/sheet-1.ipynb" &&
    fails "has no places for answers in the notebook"

# Ten names: no two with the same numbers, and the same again for the same name.
printf '%s\n' 'Ada Lovelace' 'Emmy Noether' 'Émilie du Châtelet' 'Sofja Kowalewskaja' \
    'Leonhard Euler' 'Loup Verlet' 'Carl Runge' 'Martin Kutta' 'Wilhelm Cauer' '李' >$work/names
exits 0 sheet --for $work/names --key 7 -o $work/ten
sheets=$(ls $work/usual/../ten/*.html | wc -l)
count=$(grep -c '^  [0-9]  ' $work/list)
test $sheets = $((10*count)) || fails "makes $sheets pages, not 10 times $count"
for k in $(seq $count); do
    alike=$(for page in $work/ten/sheet-$k-*.html; do
        sed -n '/<ol/,$p' $page | cksum
    done | sort | uniq -d)
    test -z "$alike" || fails "makes the same sheet $k for two names"
done
grep -l '@value\|@c ' $work/ten/* && fails "leaves quantities"
exits 0 sheet 3 --for ' ada   LOVELACE' --key 7 -o $work/again
cmp -s $work/again/sheet-3-ada-lovelace.ipynb $work/ten/sheet-3-ada-lovelace.ipynb ||
    fails "gives a name other numbers when it is written otherwise"
exits 0 sheet 3 --for 'Ada Lovelace' --key 8 -o $work/other
cmp -s $work/other/sheet-3-ada-lovelace.ipynb $work/ten/sheet-3-ada-lovelace.ipynb &&
    fails "gives the same numbers with another key"
exits 0 sheet 3 --for 'Ada Lovelace' --key 8 --as page -o $work/one
grep -q '^1 file is' $work/out || fails "has no singular"
printf 'Ada\nada\n' >$work/twice
exits 2 sheet 1 --for $work/twice --key 7 -o $work/no
says 'the name ada twice'

# Printed commands are broken before an option, never inside one.
exits 0 sheet all --for $work/names --key 7 -o $work/class.html
sed -n '/<pre class="example">/,/<\/pre>/p' $work/class.html | sed 's/<[^>]*>//g
    s/&[a-z0-9#]*;/"/g' >$work/commands
awk 'length > 80 && /^nevh|^    --/ { print; long = 1 } /^ *t-end|--$/ { print; long = 1 }
    END { exit long }' $work/commands || fails "has long commands"
test "$(grep -c '^nevh ' $work/commands)" -ge 100 || fails "has few commands"

# The usual answers are those of the sheets' answers.
exits 2 sheet 1 --answers -o $work/answers.html
says 'a table'
exits 0 sheet all --answers --format csv
cp $work/out $work/all
exits 0 sheet --answers --format csv
cmp -s $work/all $work/out || fails "makes other sheets than sheet all"
while read -r task key; do
    said=$(sed -n "s/^@set $key //p" "$srcdir/doc/sheets/numbers.texi")
    awk -F, -v task=$task -v said="$said" '
        $2 == task { found = 1; d = $3 - said; e = $3*0.06; if (e < 0) e = -e
            exit !(d <= e && -d <= e) }
        END { if (!found) exit 1 }' $work/out || fails "has another answer to $task than $said"
done <<END
1.1a first-p
1.4 rk-passes
2.2 constant-rk
3.2a disc-euler
4.3a quartic-half
5.1a moon-formula
6.1c twins-exponent
8.1 kepler-ratio
END

# Right answers are right, also rounded, with a comma, a unit and a power of ten.
for one in 1 5; do
    exits 0 sheet $one --for 'Ada Lovelace' --key 7 --answers --format csv
    cp $work/out $work/answers.$one
done
{ echo name,task,answer
    sed 1d $work/answers.1 | cut -d, -f1-3
    sed 1d $work/answers.5 | cut -d, -f1-3; } >$work/right.csv
exits 0 mark $work/right.csv --key 7 --format csv
test "$(grep -c ',right,' $work/out)" = $(($(wc -l <$work/right.csv) - 1)) ||
    fails "refuses a right answer"
# Of somebody else, or with another key, they are wrong.
sed 's/^Ada Lovelace/Carl Runge/' $work/right.csv >$work/copied.csv
exits 0 mark $work/copied.csv --key 7 --format csv
test "$(grep -c ',right,' $work/out)" -le 3 || fails "takes copied answers"
exits 2 sheet 1 --key 7 -o $work/no
says '--key needs --for'
exits 0 mark $work/right.csv --key 8 --format csv
test "$(grep -c ',right,' $work/out)" -le 3 || fails "takes answers of another key"
says 'is --key 8 that of the sheets'

answer() { awk -F, -v task=$1 '$2 == task { printf "%.6g\n", $3 }' $work/answers.${1%%.*}; }
p=$(answer 1.1a) share=$(answer 5.2) length=$(answer 5.1a) error=$(answer 1.2a)
cat >$work/mixed.csv <<END
name;task;answer
Ada Lovelace;1.1a;$(echo $p | tr . ,)
ADA LOVELACE;5.2;$(awk "BEGIN { printf \"%.1f\", 100*$share }") %
Ada Lovelace;5.1a;$length s
Ada Lovelace;1.2a;$(awk "BEGIN { printf \"%.2f\", 1000*$error }")*10^-3
Ada Lovelace;1.1a;$(awk "BEGIN { print -($p) }")
Ada Lovelace;5.1a;$(awk "BEGIN { print $length/2 }")
Ada Lovelace;5.2;$(awk "BEGIN { print 1 - $share }")
Ada Lovelace;5.1a;$(awk "BEGIN { print $length*1.31 }")
Ada Lovelace;1.2a;I do not know
Ada Lovelace;1.2b;
END
exits 0 mark $work/mixed.csv --key 7 --format csv
test "$(grep -c 'right,$' $work/out)" = 4 || { cat $work/out; fails "refuses how people write"; }
for why in 'wrong,the sign' 'wrong,half a period' 'wrong,what is lost for what is left' \
    'unreadable,' 'missing,'; do
    has "$why"
done
grep -q ',wrong,$' $work/out || fails "gives a reason where none is known"

# What a command of the sheets gives is right, too, where the answer is certified otherwise;
# no two names have the same numbers in any task.
"$python" - <<'END' || fails "has an answer that its sheet's command does not give"
from nevh import _classroom
room = _classroom.Room()
tasks = [task for task in room.tasks.values() if task.truth]
assert len(tasks) > 8
for task in tasks:
    for name in (None, "Ada Lovelace"):
        answer = _classroom.Answer(room, task, name, "7")
        assert abs(answer.measured() - answer.number) < 0.3*answer.width(answer.number), (
            task.name, answer.measured(), answer.number)
made = [_classroom.Answer(room, room.tasks[task], name, "7").number
        for task in ("1.3", "2.1a", "2.2", "3.4") for name in ("Ada Lovelace", "Carl Runge")]
assert all(abs(one/two - 1) > 0.05 for one, two in zip(made[::2], made[1::2])), made
END

# Mistakes that are computed: half the step, another method, degrees.
"$python" - >$work/known.csv <<'END'
from nevh import _classroom
from nevh._tasks import Answer
room = _classroom.Room()
print("name,task,answer")
for task, said in (("1.2b", "the step halved"), ("1.2b", "verlet for rk4"),
                   ("1.1a", "degrees for radians"), ("1.2b", "the drift for the error")):
    answer = Answer(room, room.tasks[task], "Ada Lovelace", "7")
    rule = dict(reversed(answer.task.mistakes))[said]
    print("Ada Lovelace,%s,%.4g" % (task, answer.mistaken(rule)))
END
exits 0 mark $work/known.csv --key 7
for why in 'the step halved' 'verlet for rk4' 'degrees for radians' 'the drift for the error'; do
    has "wrong  *$why"
done

printf 'name,answer\nAda,1\n' >$work/bad.csv
exits 2 mark $work/bad.csv
says 'names no column task'
printf 'name,task,answer\nAda,1.9,1\n' >$work/bad.csv
exits 2 mark $work/bad.csv
says 'line 2: there is no task 1.9'
printf 'name,task,answer\nAda,1.4,1,6,2\n' >$work/bad.csv
exits 2 mark $work/bad.csv
says 'between quotes'
exits 2 mark $work/missing.csv
exits 2 mark

# For Moodle, and as a page that marks itself and does not hold the answer.
exits 0 sheet 5 --for 'Ada Lovelace' --key 7 --as moodle -o $work/quiz.xml
exits 0 sheet 8 --for 'Ada Lovelace' --key 7 --as check -o $work/check
exits 0 sheet 8 --for 'Ada Lovelace' --key 7 --answers --format csv
ratio=$(sed -n 2p $work/out | cut -d, -f3)
grep -qF "$ratio" $work/check/*.html && fails "holds an answer in plain text"
"$python" - $work/quiz.xml $work/check/sheet-8-ada-lovelace-check.html $ratio <<'END' ||
import json, math, re, sys
import xml.etree.ElementTree as tree
from nevh import _classroom
from nevh import _sheet_export as export
room = _classroom.Room()
quiz = tree.parse(sys.argv[1]).getroot()
asked = quiz.findall("question[@type='numerical']")
assert len(asked) == 4, len(asked)
assert all(one.find("answer").get("fraction") == "100" for one in asked)
assert any(said.text for one in asked for said in one.findall("answer/feedback/text"))
# Moodle takes the first answer whose interval holds a response, and refuses a unit that the
# question does not have.
for one in asked:
    right = one.findall("answer")[0]
    number, tolerance = (float(right.findtext(part)) for part in ("text", "tolerance"))
    assert 0 < tolerance < abs(number)/5, (number, tolerance)
    answer = _classroom.Answer(room, room.tasks[one.findtext("name/text")], "Ada Lovelace", "7")
    assert abs(tolerance/answer.width(answer.number) - 1) < 1e-5, (number, tolerance)
    for wrong in one.findall("answer")[1:]:
        assert wrong.get("fraction") == "0"
        assert abs(float(wrong.findtext("text")) - number) > tolerance
    unit = re.search(r"in (\S+)\)</p>", one.findtext("questiontext/text"))
    assert one.findtext("units/unit/unit_name") == (unit and unit.group(1)), unit
    assert one.findtext("showunits") == ("0" if unit else "3")
held = json.loads(re.search(r"const held = (.*);", open(sys.argv[2]).read()).group(1))["8.1"]
right = float(sys.argv[3])


def holds(number):
    return export._digest(held["salt"], math.floor(number/held["cell"])) in held["right"]


assert holds(right) and holds(right*1.001)
assert not any(map(holds, (right*1.1, right**0.5, right**2, 1/right, -right, right/2)))
END
    fails "makes a wrong page or quiz"
if node --version >/dev/null 2>&1; then
    { sed -n '/^const held/,/<\/script>/p' $work/check/*.html | sed '/<\/script>/d'
        echo "if (!isRight(held['8.1'], '$ratio') || isRight(held['8.1'], '2$ratio')) process.exit(1)"
        echo "const hex = [...sha256(new TextEncoder().encode('abc'))].map(x => x.toString(16).padStart(2, '0')).join('')"
        echo "if (hex !== 'ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad') process.exit(2)"
    } >$work/check.js
    node $work/check.js || fails "makes a page whose script is wrong"
fi

# Without Python it says so.
PYTHON=$work/no-python
exits 2 sheet 1
says 'need Python 3'
exit $status
