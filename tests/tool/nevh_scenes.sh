#!/bin/sh
# Where the command finds scenes, and what it says where it does not; ./nevh.

. "${srcdir:-.}/tests/support/nevh_support.sh"
unset NEVH_SCENES

# In the build tree: without a variable, and from another folder.
exits 0 list scenes --format csv --quiet
grep -v "^#" $work/out | sed 1d | cut -d, -f1 >$work/listed
(cd "$srcdir/scenes" && ls *.nevh) | sed "s/\.nevh$//" | LC_ALL=C sort >$work/there
LC_ALL=C sort $work/listed | cmp - $work/there || fails "lists other scenes"
exits 0 check pendulum
here=$(pwd -P)
mkdir $work/away
(cd $work/away && "$here/$nevh" check pendulum) >$work/out 2>&1 ||
    { fails "finds no scene from another folder"; cat $work/out; }

# What was looked for, and where.
exits 2 compare pendulm
says "no file pendulm, and no scene of that name in $here/scenes; did you mean pendulum"
exits 2 compare xyzzyx
says "in $here/scenes; see nevh list scenes"
exits 2 compare nowhere/pendulum
says 'there is no file nowhere/pendulum$'
cp "$srcdir/scenes/kepler.nevh" $work/hoop.nevh
exits 2 compare $work/hoop
says 'hoop; did you mean .*/hoop\.nevh'

# None there: said, and no success.
NEVH_SCENES=$work/none
export NEVH_SCENES
exits 2 compare pendulum
says "no scenes in $work/none; set NEVH_SCENES"
exits 2 list scenes
says "no scenes in $work/none; set NEVH_SCENES"
test -s $work/out && fails "prints a table of no scenes"
unset NEVH_SCENES

# ./nevh of a clone: what it runs, from where, and what it says before a build.
clone="$work/a clone"
mkdir -p "$clone/build/tools" $work/bin
cp "$srcdir/nevh" "$clone/nevh"
command=./nevh
"$clone/nevh" list scenes >$work/out 2>$work/err
test $? = 2 || fails "exits otherwise where nothing is built"
says 'not built yet; run .*/a clone/quickstart first'
cat >"$clone/build/tools/nevh" <<'END2'
#!/bin/sh
echo "$#:$*"
exit 7
END2
chmod +x "$clone/build/tools/nevh"
ln -s "../a clone/nevh" $work/bin/nevh
ln -s bin/nevh $work/nevh-too
for way in "$clone/nevh" $work/bin/nevh $work/nevh-too; do
    "$way" compare 'a b' >$work/out 2>$work/err
    test $? = 7 || { fails "$way: another exit status"; cat $work/err; }
    has '^2:compare a b$'
done
(cd $work/bin && PATH=.:$PATH && nevh one) >$work/out 2>&1
has '^1:one$'
exit $status
