#!/bin/sh
# The manual as pages: each link leads to a page, a picture or a place of a page; each
# picture is below its command; the search finds what is in the text.
# SPDX-License-Identifier: GPL-3.0-or-later

srcdir=${srcdir:-.} status=0
work=site-test.$$ top=$PWD
trap 'cd "$top" && rm -rf $work' EXIT
trap 'exit 1' HUP INT TERM
mkdir $work || exit 1
. "$srcdir/tests/support/nevh_command.sh"
makeinfo --version >/dev/null 2>&1 || { echo "there is no makeinfo"; exit 77; }
MAKEINFO=makeinfo sh "$srcdir/doc/site/site.sh" "$srcdir" "$nevh" $work/site ||
    { echo "site.sh fails"; exit 1; }
cd $work/site || exit 1

# Links, as FILE#PLACE, beside all places there are.
grep -o "\(href\|src\)=[\"'][^\"']*" ./*.html | tr "'" '"' |
    grep -v '"\(https\?\|mailto\):' | sed 's/^\.\/\([^:]*\):[a-z]*="/\1 /' |
    awk '{ print $2 ~ /^#/ ? $1 $2 : $2 }' | sort -u >../links
{
    ls
    ls pictures/*
    grep -o " \(id\|name\)=[\"'][^\"']*" ./*.html | tr "'" '"' |
        sed 's/^\.\/\([^:]*\):.*="/\1#/'
} | sort -u >../places
comm -23 ../links ../places >../nowhere
test -s ../nowhere && { echo "links lead nowhere:"; cat ../nowhere; status=1; }
test "$(wc -l <../links)" -gt 500 || { echo "few links are compared"; status=1; }

for page in Pictures Areas Tutorial; do
    grep -q '<figure><a href="pictures/' $page.html ||
        { echo "$page.html has no picture"; status=1; }
done
test "$(ls pictures | wc -l)" -ge 12 || { echo "there are few pictures"; status=1; }
test "$(grep -c '<figure>' gallery.html)" -eq "$(ls pictures | wc -l)" ||
    { echo "the gallery lacks pictures"; status=1; }

# The index, and the weights of search.js, in node where it is.
if node --version >/dev/null 2>&1; then
    cat >../find.js <<'END'
const fs = require("fs"), vm = require("vm");
const field = { value: "", form: { addEventListener() {} }, addEventListener() {} };
const scope = { document: { getElementById: () => field } };
vm.createContext(scope);
vm.runInContext(fs.readFileSync("search-index.js", "utf8") +
  fs.readFileSync("search.js", "utf8") +
  "; globalThis.best = (words) => siteEntries.map((e) => [weigh(words, e), e[0]])" +
  ".filter(([w]) => w > 0).sort((a, b) => b[0] - a[0]).map(([, page]) => page);", scope);
const wanted = { lyapunov: "Chaos.html", "plot-kind animation": "Pictures.html",
  "separable stiff zzz": undefined };
for (const [words, page] of Object.entries(wanted)) {
  const found = scope.best(words.split(" ")), first = found[0];
  if (page ? !found.slice(0, 5).some((at) => at.startsWith(page)) : first) {
    console.log(`${words}: found ${found.slice(0, 5)}`);
    process.exitCode = 1;
  }
}
END
    node ../find.js || status=1
fi
exit $status
