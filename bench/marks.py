"""How well nevh sheet and nevh mark do: worksheets for many names, and simulated answers.

    python3 bench/marks.py [NAMES [SHEETS]]

makes all worksheets for NAMES (200) and looks for two with the same numbers, then marks
SHEETS (10000) simulated answer sheets of some of these names: right answers rounded as
people round, and wrong ones by the mistakes of doc/sheets/tasks.list.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import collections
import decimal
import math
import random
import sys
import tempfile
import time

from nevh import _classroom
from nevh._hand_in import typed

KEY = "bench"


def digits(number, count):
    return "%.*g" % (count, number)


def half_up(number, unit):
    """A number to a multiple of a power of ten, halves away from 0, as people round."""
    return decimal.Decimal(number).quantize(unit, decimal.ROUND_HALF_UP)


def rounded(number, task, chance):
    """A number as people write it."""
    style = chance.choice(["asked", "asked", "more", "all", "truncated", "power", "comma",
                           "long", "twice"])
    if task.kind == "decimals":
        places = task.digits + (style in ("more", "long")) + 3*(style == "all")
        if style == "truncated":
            made = "%.*f" % (places, math.trunc(number*10**places)/10**places)
        else:
            made = "%.*f" % (places, number)
    else:
        count = task.digits + (style in ("more", "power") and chance.random() < 0.5) + \
            2*(style == "long") + 4*(style == "all")
        if style == "truncated" and number:
            unit = 10.0**(math.floor(math.log10(abs(number))) - count + 1)
            number = math.trunc(number/unit)*unit
        made = digits(number, count)
        if style == "twice" and number:  # 116.3457, 116.35, 116.4
            unit = decimal.Decimal(1).scaleb(decimal.Decimal(number).adjusted() - count + 1)
            made = format(half_up(half_up(number, unit/10), unit), "f")
        if style == "power":
            mantissa, power = ("%.*e" % (count - 1, number)).split("e")
            made = mantissa + chance.choice(["*10^", " x 10^", "\u00b710^"]) + str(int(power))
    if style == "comma":
        made = made.replace(".", ",")
    if chance.random() < 0.1:
        made += " " + (task.unit or "")
    return made


def two(number):
    return float("%.1e" % number)


def worked_out(room, answer, name):
    """A right answer from the numbers of a table, which have two digits; or None."""
    from nevh._tasks import filled

    def number(key):
        listed = room.numbers[key]
        return two(room.measured.number(*(filled(text, answer.quantities()) for text in (
            listed.command, listed.program))))
    if answer.task.key == "rk-grown":
        return number("rk-thousand")/number("rk-twenty")
    if answer.task.key == "rk-passes":
        return number("verlet-thousand")/number("rk-drift")
    if answer.task.key == "twins-exponent":
        late, early = (float(answer.quantities()[one]) for one in ("late", "early"))
        return math.log(number("twins-late")/number("twins-early"))/(late - early)
    return None


def make_all(names):
    """Seconds for all sheets, and pairs of names with the same numbers in one."""
    room, began, alike = _classroom.Room(), time.time(), 0
    with tempfile.TemporaryDirectory() as folder:
        with open(folder + "/names", "w", encoding="utf-8") as file:
            file.write("\n".join(names))
        sys.stdout.flush()
        _classroom.main(["sheet", "--for", folder + "/names", "--key", KEY, "--as", "page",
                         "--output", folder])
        _classroom.main(["sheet", "--for", folder + "/names", "--key", KEY, "--as",
                         "notebook", "--output", folder])
    spent = time.time() - began
    for number, quantities in room.quantities.items():
        seen = collections.Counter(tuple(quantities.of(name, KEY, number).values())
                                   for name in names)
        alike += sum(count - 1 for count in seen.values())
    return spent, alike


def main(names=200, sheets=10000, marked=25):
    chance = random.Random(1)
    names = ["Student %d" % k for k in range(int(names))]
    spent, alike = make_all(names)
    print("%d names x all sheets, pages and notebooks: %.1f s; alike in a sheet: %d" % (
        len(names), spent, alike))
    room, count, began = _classroom.Room(), collections.Counter(), time.time()
    missed, refused, taken = collections.Counter(), [], []
    some = names[:int(marked)]
    answers = {(name, number): room.answers(number, name, KEY)
               for name in some for number in room.quantities}
    print("answers of %d names: %.1f s" % (len(some), time.time() - began))
    certified = [abs(answer.measured() - answer.number)/answer.width(answer.number)
                 for each in answers.values() for answer in each if answer.task.truth]
    print("%d answers by formulas and nevh reference: the sheets' commands differ by at most "
          "%.3f of what is allowed" % (len(certified), max(certified)))
    for name, number in answers:
        for answer in answers[name, number]:
            known = answer.mistakes()
            count["mistakes"] += len(answer.task.mistakes)
            count["the same number"] += len(answer.task.mistakes) - len(known)
    for _ in range(int(sheets)):
        name, number = chance.choice(list(answers))
        for answer in answers[name, number]:
            task = answer.task
            if chance.random() < 0.5:
                value = chance.random() < 0.3 and worked_out(room, answer, name) or \
                    answer.number
                text = rounded(value, task, chance)
                verdict = answer.judged(typed(text, task.unit))
                count["right"] += 1
                if verdict[0] != "right":
                    refused.append((name, task.name, text, answer.number, verdict))
                continue
            said, value = chance.choice(answer.mistakes())
            text = rounded(value, task, chance)
            if task.kind == "decimals" and float(typed(text).number) == 0:
                text = "%.4g" % value
            verdict, why = answer.judged(typed(text, task.unit))
            count["wrong"] += 1
            if verdict == "right":
                taken.append((name, task.name, text, answer.number, said))
            elif why == said:
                count["named"] += 1
            else:
                missed[task.name, said, why] += 1
                count["named otherwise" if why else "not named"] += 1
    print("%d answer sheets: %d right answers, %d refused; %d wrong ones, %d accepted; "
          "named %.1f %%, by the words of another mistake %.1f %%, not named %.1f %%" % (
              int(sheets), count["right"], len(refused), count["wrong"], len(taken),
              *(100*count[one]/max(count["wrong"], 1)
                for one in ("named", "named otherwise", "not named"))))
    print("%d of %d mistakes give a number that may be the right one, and were left out"
          % (count["the same number"], count["mistakes"]))
    for one in refused[:10]:
        print("refused:", *one)
    for one in taken[:10]:
        print("accepted:", *one)
    for one, often in missed.most_common(12):
        print("missed:", often, *one)
    return bool(refused or taken)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
