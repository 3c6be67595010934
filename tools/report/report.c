/* nevh report: what the other commands say of a scene, as one page of HTML.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "animation_private.h"
#include "report_private.h"
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct {
    const options *given;
    char *folder, *rows, *picture, *narrow, *messages; /* files of one part */
    size_t animations;                                 /* on the page */
    size_t parts;                                      /* so far */
    list contents; /* of a scene: numbers and titles of its parts */
    int terminal;  /* stderr, where messages of a part go to a file; else -1 */
    bool full;     /* a part, or its messages, could not be written */
} report_job;

enum { STARTS = 2, ANIMATION_BYTES = 100000 };

char *text_read(const char *name) {
    size_t size;
    char *text = file_read(fopen(name, "rbe"), &size);
    return size ? text : NULL;
}

static char *add_list(char *line, const char *option, const list *items) {
    char *joined = text_print("%s", items->count ? items->item[0] : "");
    for (size_t i = 1; i < items->count; i++)
        text_extend(&joined, ",%s", items->item[i]);
    if (items->count)
        line = shell_option(line, option, joined);
    return line;
}

/* With the options that the report was given. */
static char *command_of(const report_job *w, const char *scene,
                        const char *arguments) {
    const options *o = w->given;
    size_t word = strcspn(arguments, " ");
    char *line = shell_line(o, text_print("%.*s", (int)word, arguments), scene);
    char *text = text_print("%s%s", line + strspn(line, " "), arguments + word);
    text = add_list(text, "integrators", &o->integrators);
    text = add_list(text, "gradient", &o->gradients);
    text = add_list(text, "dt", &o->dt);
    for (size_t i = 0; i < o->vary.count; i++)
        text = shell_option(text, "vary", o->vary.item[i]);
    return o->t_end ? shell_option(text, "t-end", o->t_end) : text;
}

/* Several starts for a portrait where the scene has one, or more than can be told apart. */
static void choose_starts(options *o, nevh_scene *scene) {
    enum { COUNT = 6 };
    double q = 0, p = 0;
    uint64_t members = nevh_scene_members(scene);
    if ((members && members <= 4 * COUNT) || nevh_scene_start(scene, &q, &p) ||
        (q == 0 && p == 0))
        return;
    o->vary = (list){0};
    list_print(&o->vary, "%s%s = range(%.3g, %.3g, %d)", q != 0 ? "" : "p_",
               nevh_scene_coordinate(scene, 0), (q != 0 ? q : p) / COUNT,
               q != 0 ? q : p, COUNT);
}

/* The first integrator, and those of the scene that lose or gain energy: a panel
   each. */
static void choose_panels(options *o, nevh_scene *scene) {
    static const char *const others[] = {"rk4", "euler"};
    const nevh_scene_run *run = nevh_scene_run_settings(scene);
    if (o->integrators.count || run->integrators < 3)
        return;
    o->integrators = (list){0};
    list_add(&o->integrators, run->integrator[0]);
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        for (size_t i = 1; i < run->integrators; i++)
            if (strcmp(run->integrator[i], others[k]) == 0)
                list_add(&o->integrators, others[k]);
    if (o->integrators.count == 1)
        list_add(&o->integrators, run->integrator[1]);
}

/* Runs a command with stderr in a file; -1 where that cannot be. */
static int run_heard(report_job *w, const command *c, const options *o) {
    int kept = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0), status = -1;
    FILE *heard = fopen(w->messages, "we");
    fflush(stderr);
    if (kept >= 0 && heard && dup2(fileno(heard), STDERR_FILENO) >= 0) {
        w->terminal = kept;
        status = c->run(o);
        fflush(stderr);
        w->full |= ferror(stderr);
        clearerr(stderr);
        dup2(kept, STDERR_FILENO);
        w->terminal = -1;
    }
    if (heard)
        fclose(heard);
    if (kept >= 0)
        close(kept);
    w->full |= status == -1 || output_failed();
    return status;
}

static report_part make_part(report_job *w, const kind_of_part *kind,
                             char *scene, nevh_scene *read) {
    char *words[] = {"report", scene};
    options o = *w->given;
    o.operands = (list){words, 2};
    o.file = kind->rows ? w->rows : NULL;
    o.plot.file = kind->draws ? w->picture : NULL;
    o.plot.narrow = w->narrow;
    o.plot.kind = kind->kind;
    o.chaos.starts = kind->of == &chaos_command ? STARTS : 0;
    o.search.budget = kind->budget;
    o.as_html = true;
    o.quiet = !kind->rows;
    o.all = false;
    if (kind->of == &portrait_command) {
        choose_starts(&o, read);
        choose_panels(&o, read);
    }
    unlink(w->rows);
    unlink(w->picture);
    unlink(w->narrow);
    report_part part = {.title = kind->title, .about = kind->about};
    part.status = run_heard(w, kind->of, &o);
    part.html = text_read(w->rows);
    part.picture = text_read(w->picture);
    part.narrow = text_read(w->narrow);
    part.messages = text_read(w->messages);
    part.command =
        command_of(&(report_job){.given = &o}, scene, kind->arguments);
    return part;
}

/* The command whose rows have the errors that the picture moves by. */
static char *animation_command(const report_job *w, const animation *f,
                               const char *scene) {
    options o = *w->given;
    report_job as = {.given = &o};
    double end = f->plan->run->t_start + (double)f->most * f->dt;
    char *dt = text_print("%.3g", f->dt), *t_end = text_print("%.15g", end);
    o.integrators = o.dt = (list){0};
    list_add(&o.integrators, f->recording[0].integrator);
    list_add(&o.integrators, f->recording[1].integrator);
    list_add(&o.dt, dt);
    o.t_end = t_end;
    return command_of(&as, scene, "compare");
}

/* Without HTML where there is none. */
static report_part make_animation(const report_job *w, const kind_of_part *kind,
                                  char *scene) {
    char *words[] = {"report", scene};
    options o = *w->given;
    report_part part = {.title = kind->title, .about = kind->about};
    plan p = {0};
    animation f = {0};
    o.operands = (list){words, 2};
    if (!plan_make(&p, &o) &&
        animation_make(&f, &p, ANIMATION_BYTES / w->animations)) {
        text_file html;
        animation_html(&f, text_open(&html));
        part.html = text_close(&html);
        part.command = animation_command(w, &f, scene);
        part.by = "The same runs:";
    }
    plan_free(&p);
    return part;
}

/* True if a row of the comparison has a verdict, and so numbers. */
static bool has_verdict(const report_part *part) {
    for (int v = 0; part->html && v <= NEVH_UNDECIDED; v++) {
        char *cell = text_print("<td>%s</td>", nevh_verdict_name(v));
        if (strstr(part->html, cell))
            return true;
    }
    return false;
}

/* The comparison is what a report is for: without it there is none. */
static int refuse(const char *scene, const report_part *part) {
    fputs(part->messages ? part->messages : "", stderr);
    tool_refuse("%s: no report, since no integrator has a row with numbers",
                scene);
    return part->status == TOOL_FAILED ? TOOL_FAILED : TOOL_USAGE;
}

/* Not where the part has nothing to show. */
static int add_part(report_job *w, const kind_of_part *kind, char *name,
                    variant *v, FILE *f) {
    int status = TOOL_OK;
    w->given = &v->given;
    report_part part = kind->of ? make_part(w, kind, name, v->scene)
                                : make_animation(w, kind, name);
    part.variant = v->name;
    if (w->full)
        status = tool_refuse("%s: parts of the report cannot be written: is "
                             "the disk full?",
                             w->folder);
    else if (kind->of == &compare_command &&
             (part.status == TOOL_USAGE || !has_verdict(&part)))
        status = refuse(name, &part);
    else if (part.command) {
        if (kind->of == &compare_command)
            html_find_facts(part.html, &v->facts, &v->earlier);
        html_part(f, &part, ++w->parts, &v->earlier);
        list_print(&w->contents, "%zu %s%s%s", w->parts, kind->title,
                   v->name ? ": " : "", v->name ? v->name : "");
    }
    return status;
}

static bool is_shown(const options *o, const kind_of_part *kind,
                     nevh_scene *scene) {
    return kind->wanted(scene) &&
           (o->all || (kind->usual && kind->usual(scene)));
}

/* Variants side by side. */
static int add_kind(report_job *w, const kind_of_part *kind, char *name,
                    const variants *all, FILE *f) {
    int status = TOOL_OK;
    size_t wanted = 0;
    for (size_t i = 0; i < all->count; i++)
        wanted += is_shown(&all->item[i].given, kind, all->item[i].scene);
    if (!wanted)
        return TOOL_OK;
    html_side_by_side(f, all->count, true);
    for (size_t i = 0; !status && i < all->count; i++)
        if (is_shown(&all->item[i].given, kind, all->item[i].scene))
            status = add_part(w, kind, name, &all->item[i], f);
    html_side_by_side(f, all->count, false);
    return status;
}

/* The title, contents and facts, which are known when its parts have been made. */
static void begin_scene(report_job *w, const options *o, const char *name,
                        const variants *all, FILE *f) {
    html_title(f, all->item->scene, plan_title(all->item->scene, name, o));
    html_contents(f, &w->contents);
    html_side_by_side(f, all->count, true);
    for (size_t i = 0; i < all->count; i++)
        html_scene(f, all->item[i].scene, all->item[i].name,
                   &all->item[i].facts);
    html_side_by_side(f, all->count, false);
}

static int add_scene(report_job *w, const options *o, char *name, FILE *f) {
    variants all;
    text_file text;
    int status = variants_open(&all, o, name);
    FILE *parts = text_open(&text);
    for (const kind_of_part *k = report_kinds; !status && k->title; k++)
        status = add_kind(w, k, name, &all, parts);
    const char *made = text_close(&text);
    if (!status) {
        begin_scene(w, o, name, &all, f);
        fputs(made, f);
    }
    w->contents = (list){0};
    variants_close(&all);
    return status;
}

static void remove_folder(const report_job *w) {
    const char *const files[] = {w->rows, w->picture, w->narrow, w->messages};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        if (files[i])
            unlink(files[i]);
    rmdir(w->folder);
}

/* Copies the messages of a part to the terminal when it ends the program. */
static void copy_messages(const report_job *w) {
    char text[512];
    int file = w->terminal < 0 ? -1 : open(w->messages, O_RDONLY | O_CLOEXEC);
    for (ssize_t bytes = 0; file >= 0 && bytes >= 0;) {
        bytes = read(file, text, sizeof text);
        if (bytes <= 0 || write(w->terminal, text, (size_t)bytes) < 0)
            break;
    }
    if (file >= 0)
        close(file);
}

/* The report that is being made. */
static const report_job *volatile unfinished;

static void leave(int number) {
    if (!number)
        copy_messages(unfinished);
    remove_folder(unfinished);
}

static int make_folder(report_job *w) {
    const char *parent = getenv("TMPDIR");
    w->folder =
        text_print("%s/nevh.XXXXXX", parent && *parent ? parent : "/tmp");
    if (!mkdtemp(w->folder))
        return tool_refuse("%s: a folder for parts of the report cannot be "
                           "made: %s",
                           w->folder, strerror(errno));
    unfinished = w;
    output_leave(leave);
    w->rows = text_print("%s/rows.html", w->folder);
    w->picture = text_print("%s/picture.svg", w->folder);
    w->narrow = text_print("%s/narrow.svg", w->folder);
    w->messages = text_print("%s/messages", w->folder);
    return TOOL_OK;
}

static void free_work(report_job *w) {
    output_leave(NULL);
    if (w->messages)
        remove_folder(w);
}

static int write_page(const options *o, const char *text) {
    output out;
    if (output_open(&out, o->file))
        return TOOL_USAGE;
    fputs(text, out.stream);
    return output_close(&out, TOOL_OK);
}

/* The title, for tabs and bookmarks: the scenes. */
static void begin_page(const options *o, FILE *f) {
    char *title = text_print("%s", "nevh report");
    for (size_t i = 1; i < o->operands.count; i++)
        text_extend(&title, "%s%s", i > 1 ? ", " : ": ", o->operands.item[i]);
    html_head(f, title, o->variants.count > 1);
}

static int report(const options *o) {
    report_job w = {.given = o, .terminal = -1};
    text_file text;
    if (o->operands.count < 2)
        return tool_refuse("nevh report takes scenes, as in nevh report "
                           "pendulum -o pendulum.html");
    if (!o->file)
        return tool_refuse("nevh report needs a file: -o FILE.html");
    if (output_check(o->file) || make_folder(&w)) {
        free_work(&w);
        return TOOL_USAGE;
    }
    FILE *f = text_open(&text);
    int status = TOOL_OK;
    begin_page(o, f);
    w.animations =
        (o->operands.count - 1) * (o->variants.count ? o->variants.count : 1);
    for (size_t i = 1; !status && i < o->operands.count; i++)
        status = add_scene(&w, o, o->operands.item[i], f);
    html_foot(f);
    const char *made = text_close(&text);
    free_work(&w);
    return status ? status : write_page(o, made);
}

const command report_command = {
    .name = "report",
    .operand = "SCENE...",
    .brief = "one HTML page of tables and pictures",
    .help =
        "one page of HTML with the tables and pictures of the other commands; some four pages in print",
    .examples = "report pendulum -o pendulum.html\n"
                "report pendulum --variant g=1.6 -o moon.html",
    .options = "SCENE STEPS variant all output",
    .run = report,
};
