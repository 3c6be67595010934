/* nevh: what the parts of the command share.

   commands.h lists the commands.  Each is a `command` below, at the end of the
   file that implements it: its name, help, options, columns and function, from
   which nevh.c, help, completion and the page for man are made.

   Commands of scenes begin with a plan (plan.h): scene, options and
   defaults made into what is to be run.  Most end with a page: notes, a table
   (table.c), words.  Those that draw fill a plot (plot.h), which is
   written as SVG or drawn by gnuplot.  FILE_private.h is shared by the files that are named FILE_*.c.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TOOL_H
#define NEVH_TOOL_H

#include <errno.h>
#include <nevh/nevh.h>
#include <nevh/scene.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/types.h>

/* memory.c.  The command's memory lives until the program ends: no function frees
   texts or rows.  Where memory is out the program ends. */
void *tool_allocate(size_t count, size_t size);        /* zeros */
void *tool_enlarge(void *, size_t count, size_t size); /* as realloc */
/* An array with room for one after `count`, which doubles where it is enlarged.
   items  of tool_allocate, tool_enlarge or tool_grown; NULL: none yet */
void *tool_grown(void *items, size_t count, size_t size);
/* Frees sooner: what is made again at each step of something long.  NULL is allowed. */
void tool_release(void *);
void tool_release_all(void); /* for programs that run command after command */
/* Text that the library or libc allocated; NULL stays NULL. */
char *text_adopt(char *);
/* A text that is written as a file is; nothing else is done with it until it is
   closed. */
typedef struct {
    FILE *file;
    char *text;
    size_t size;
} text_file;
FILE *text_open(text_file *);
char *text_close(text_file *);
#ifdef NEVH_COMMAND
#define free(memory) tool_release_or_nothing(memory) /* links nowhere */
#endif

/* Exit statuses. */
enum { TOOL_OK, TOOL_FAILED, TOOL_USAGE, TOOL_STOPPED };

/* words.c: texts and lists of them. */
typedef struct {
    char **item;
    size_t count;
} list;
void list_add(list *, const char *text); /* a copy */
__attribute__((format(printf, 2, 3))) void list_print(list *,
                                                      const char *format, ...);
void list_split(list *, const char *text); /* at commas, */
void list_split_at(list *, const char *text, char mark);
bool list_has(const list *, const char *text);
char *list_joined(const list *);                     /* with commas */
char *list_sentence(const list *, const char *last); /* "a, b or c" */
/* Returns the pointer; NULL, as the library returns for exhausted memory, ends the
   program. */
void *tool_owned(void *);
/* A status of the library; where it is NEVH_ENOMEM the program ends, too: a row
   that is refused, or a value left out, would say something about the scheme. */
int tool_status(int status);
#define nevh_chaos_confirm(...) tool_status(nevh_chaos_confirm(__VA_ARGS__))
#define nevh_chaos_find(...)    tool_status(nevh_chaos_find(__VA_ARGS__))
#define nevh_chaos_run(...)     tool_status(nevh_chaos_run(__VA_ARGS__))
#define nevh_chaos_status(...)  tool_status(nevh_chaos_status(__VA_ARGS__))
#define nevh_energy_status(...) tool_status(nevh_energy_status(__VA_ARGS__))
#define nevh_field_energy_floor(...)                                           \
    tool_status(nevh_field_energy_floor(__VA_ARGS__))
#define nevh_field_gradient(...)  tool_status(nevh_field_gradient(__VA_ARGS__))
#define nevh_field_status(...)    tool_status(nevh_field_status(__VA_ARGS__))
#define nevh_field_value(...)     tool_status(nevh_field_value(__VA_ARGS__))
#define nevh_frequencies(...)     tool_status(nevh_frequencies(__VA_ARGS__))
#define nevh_loop_carry(...)      tool_status(nevh_loop_carry(__VA_ARGS__))
#define nevh_loop_status(...)     tool_status(nevh_loop_status(__VA_ARGS__))
#define nevh_probe_status(...)    tool_status(nevh_probe_status(__VA_ARGS__))
#define nevh_rates_at(...)        tool_status(nevh_rates_at(__VA_ARGS__))
#define nevh_reversal_defect(...) tool_status(nevh_reversal_defect(__VA_ARGS__))
#define nevh_run(...)             tool_status(nevh_run(__VA_ARGS__))
#define nevh_run_until(...)       tool_status(nevh_run_until(__VA_ARGS__))
#define nevh_scene_enable(...)    tool_status(nevh_scene_enable(__VA_ARGS__))
#define nevh_scene_judged_value(...)                                           \
    tool_status(nevh_scene_judged_value(__VA_ARGS__))
#define nevh_scene_member_start(...)                                           \
    tool_status(nevh_scene_member_start(__VA_ARGS__))
#define nevh_scene_number(...) tool_status(nevh_scene_number(__VA_ARGS__))
#define nevh_scene_part_values(...)                                            \
    tool_status(nevh_scene_part_values(__VA_ARGS__))
#define nevh_scene_section_cross(...)                                          \
    tool_status(nevh_scene_section_cross(__VA_ARGS__))
#define nevh_scene_section_items(...)                                          \
    tool_status(nevh_scene_section_items(__VA_ARGS__))
#define nevh_scene_set(...) tool_status(nevh_scene_set(__VA_ARGS__))
#define nevh_scene_set_judged(...)                                             \
    tool_status(nevh_scene_set_judged(__VA_ARGS__))
#define nevh_scene_set_outcomes(...)                                           \
    tool_status(nevh_scene_set_outcomes(__VA_ARGS__))
#define nevh_scene_set_start(...) tool_status(nevh_scene_set_start(__VA_ARGS__))
#define nevh_scene_shown_values(...)                                           \
    tool_status(nevh_scene_shown_values(__VA_ARGS__))
#define nevh_scene_start(...)  tool_status(nevh_scene_start(__VA_ARGS__))
#define nevh_scene_status(...) tool_status(nevh_scene_status(__VA_ARGS__))
#define nevh_scene_stop_reached(...)                                           \
    tool_status(nevh_scene_stop_reached(__VA_ARGS__))
#define nevh_scene_vary(...)      tool_status(nevh_scene_vary(__VA_ARGS__))
#define nevh_sections_status(...) tool_status(nevh_sections_status(__VA_ARGS__))
#define nevh_stepper_apply(...)   tool_status(nevh_stepper_apply(__VA_ARGS__))
#define nevh_stepper_status(...)  tool_status(nevh_stepper_status(__VA_ARGS__))
#define nevh_symplecticity_defect(...)                                         \
    tool_status(nevh_symplecticity_defect(__VA_ARGS__))
/* Returns the number; NAN for exhausted memory ends the program. */
double tool_number(double);
#define nevh_stability_limit(...)                                              \
    (errno = 0, tool_number(nevh_stability_limit(__VA_ARGS__)))
#define nevh_stability_growth(...)                                             \
    (errno = 0, tool_number(nevh_stability_growth(__VA_ARGS__)))
#define nevh_stability_angle(...)                                              \
    (errno = 0, tool_number(nevh_stability_angle(__VA_ARGS__)))
/* So every object that the command asks for is there. */
#define nevh_energy_new(...)                                                   \
    ((nevh_energy *)tool_owned(nevh_energy_new(__VA_ARGS__)))
#define nevh_field_new(...)                                                    \
    ((nevh_field *)tool_owned(nevh_field_new(__VA_ARGS__)))
#define nevh_probe_new(...)                                                    \
    ((nevh_probe *)tool_owned(nevh_probe_new(__VA_ARGS__)))
#define nevh_rates_new(...)                                                    \
    ((nevh_rates *)tool_owned(nevh_rates_new(__VA_ARGS__)))
#define nevh_stepper_new(...)                                                  \
    ((nevh_stepper *)tool_owned(nevh_stepper_new(__VA_ARGS__)))
#define nevh_stepper_copy(...)                                                 \
    ((nevh_stepper *)tool_owned(nevh_stepper_copy(__VA_ARGS__)))
#define nevh_sections_new(...)                                                 \
    ((nevh_sections *)tool_owned(nevh_sections_new(__VA_ARGS__)))
#define nevh_system_new(...)                                                   \
    ((nevh_system *)tool_owned(nevh_system_new(__VA_ARGS__)))
#define nevh_system_from(...)                                                  \
    ((nevh_system *)tool_owned(nevh_system_from(__VA_ARGS__)))
__attribute__((format(printf, 1, 2))) char *text_print(const char *format, ...);
/* Appends to a text, which may move; NULL: an empty one. */
__attribute__((format(printf, 2, 3))) void text_extend(char **text,
                                                       const char *format, ...);
/* The item that `name` may have been meant for; NULL when none is close. */
const char *list_closest(const list *, const char *name);
/* Words of a help text between columns, in lines of 80 characters: the first
   begins after `used` characters. */
void help_print(FILE *, int used, int column, const char *text);
/* "nevh: " and the message on stderr; returns TOOL_USAGE. */
__attribute__((format(printf, 1, 2))) int tool_refuse(const char *format, ...);
/* The same for a name that is none of the list: "unknown KIND NAME", and the
   closest, or all where they are few. */
int tool_unknown(const char *kind, const char *name, const list *known);

/* numbers.c */
int numbers_compare(const void *, const void *); /* doubles, as qsort asks */
void numbers_sort(double[], size_t count);
double numbers_median(double[], size_t count); /* sorts them; 0 of none */
enum { NUMBER_SIZE = 32 };
/* Writes the shortest of 15 to 17 digits that read back as the number; returns
   `text`. */
const char *number_text(char text[NUMBER_SIZE], double number);
double cpu_seconds(void);
double wall_seconds(void);
uint64_t digest_begin(void);
uint64_t digest_add(uint64_t digest, const void *bytes, size_t count);

/* table.c: rows of texts and numbers. */
typedef enum { FORMAT_TABLE, FORMAT_CSV, FORMAT_JSON } table_format;
typedef struct table table;
table *table_new(void);
/* The next column; lines of the title are separated by \n, parts of a word by
   -\n.  CSV and JSON have it on one line. */
void table_column(table *, const char *title);
void table_titles(table *, const char *titles); /* several, with commas */
/* The next column and those after it may go below, where they are more than fit
   beside each other. */
void table_break(table *);
/* The last column says which row it is: it is shown again there. */
void table_key(table *);
/* Aligned text has the last column below its row, in lines of 80 characters. */
void table_below(table *);
/* The next cell of the row.  NULL, and numbers that are not finite, leave it
   empty. */
void table_text(table *, const char *text);
void table_number(table *, double number); /* all its digits, */
void table_round(table *);                 /* or, from here on, ten */
void table_error(table *, double error);   /* as people read it: two */
/* A number as it is to be shown, set to the right. */
__attribute__((format(printf, 2, 3))) void table_shown(table *,
                                                       const char *format, ...);
/* Begins a group of rows, set off by an empty line. */
void table_group(table *);
/* The whole: lines before and after are set off by "# " in CSV (those after
   are left out there, and all with --quiet), and called notes and verdict in
   JSON. */
typedef struct {
    list before, after;
    table *table;
} page;
void json_string(const char *text, FILE *);

/* sample.c */
extern const char scene_sample[];

/* options.c: the command line. */
typedef enum { MATCH_SCENE, MATCH_STEPS, MATCH_WORK } matching;
/* The kinds of pictures of nevh run: the name, what it draws and its help.  The
   function plot_NAME is in tools/orbit.
   COLUMNS  those of --columns, and --data
   PICTURE  the scene's [picture]
   RUN      neither */
#define RUN_PLOTS(X)                                                           \
    X(phase, COLUMNS, ": phase (the default)")                                 \
    X(time, COLUMNS, ", time")                                                 \
    X(energy, RUN, ", energy")                                                 \
    X(configuration, PICTURE, ", configuration")                               \
    X(animation, PICTURE, ", animation (a .gif of that)")
#define PLOT_KIND(name, draws, help) PLOT_KIND_##name,
#define PLOT_WORD(name, draws, help) "|" #name
#define PLOT_HELP(name, draws, help) help
typedef enum {
    PLOT_USUAL,                          /* the command's own */
    RUN_PLOTS(PLOT_KIND) PLOT_KIND_order /* of compare and cost */
} plot_kind;
typedef struct {
    list operands, given;                  /* the names of the options given */
    list settings, integrators, gradients; /* settings: see below */
    list sections;
    list variants; /* of report: settings, as --set takes them */
    list dt, at;   /* formulas of the scene's parameters */
    double *tolerance;
    size_t tolerances;
    const char *t_end;    /* a formula; NULL: the scene's */
    const char *after;    /* of section: a formula, or NULL */
    double gradient_step; /* 0: not given, as all numbers below */
    size_t every, samples, digits;
    matching match;
    const char *file, *transform, *resume, *from, *observable, *columns;
    const char *shape; /* of flow; NULL: chosen */
    table_format format;
    bool as_html; /* tables are parts of a report */
    bool quiet, portable, all, diagnostics, impact, allow_code, header;
    struct { /* --plot and what belongs to it; NULL: not given */
        const char *file, *script;
        const char *narrow; /* of a report: the same for a telephone */
        bool is_narrow;     /* it is laid out so itself */
        plot_kind kind;
    } plot;
    struct {
        nevh_native_use use;
        bool no_cache;
    } native;
    struct { /* of cost and recommend */
        double energy_error, state_error, error;
        double budget; /* seconds; of chaos, too; 0: not given */
        size_t repeats;
        unsigned by, against; /* 1: the state; the length */
    } search;
    struct { /* of fit; data: a file of measured points */
        const char *data;
        double sigma;
    } fit;
    struct {
        size_t starts, exponents, deviations;
        bool all; /* exponents */
    } chaos;
    /* Options of sweep. */
    list vary; /* lines of [ensemble] */
    const char *outcomes, *picture;
    size_t threads, width;
    size_t task, tasks; /* part `task` of `tasks` */
    double stop_after;  /* seconds */
    bool retry, join;
    struct { /* of sheet and mark; names: one, or a file of them */
        const char *names, *key;
        unsigned form; /* of the words of --as */
        bool answers;
    } sheet;
    bool no_steps; /* the command takes no dt; it ends with the last of `at` */
    bool help, version;
} options;

/* An option.
   kind    what its argument is; "flag": there is none
   target  the member of the options that `read` sets
   group   of options that commands take together, or NULL; ALL: of all commands
   words   of a choice, with | between them: of an enumeration from `first`
   most    the largest count, or 0
   mark    before each item of the settings */
typedef struct option_row option_row;
struct option_row {
    const char *name, *argument, *kind;
    int (*read)(options *, const option_row *, const char *argument);
    size_t target;
    const char *group, *help, *words;
    unsigned first;
    size_t most;
    char letter, mark;
};
extern const option_row option_rows[];           /* until one without a name */
const option_row *option_find(const char *name); /* or NULL */
bool option_given(const options *, const char *name);

/* A command.
   operands  the words that the operand may be, with | between them, or NULL
   brief     a line for the list that nevh prints alone; NULL: not there
   examples  commands without "nevh ", a line each, that anyone can type:
             tests/tool/nevh_help.sh runs them
   options   names of options, and groups of them in capitals, with spaces between
   columns   of the CSV, with commas between them, before those that a scene or an
             option adds; NULL: there is no such table
   draws     the kinds of plot that --plot-kind may name, with | between them
   more      prints what nevh help COMMAND has after the options; or NULL
   instead   an option that it could be thought to take, and what to do instead */
typedef struct {
    const char *name, *operand, *operands, *brief, *help, *examples, *options;
    const char *columns, *draws;
    struct {
        const char *option, *advice;
    } instead;
    void (*more)(FILE *);
    int (*run)(const options *);
} command;
bool command_takes(const command *, const option_row *);
/* Checks that the command takes the options it names; for a test of all commands. */
int command_takes_known(const command *);

/* A setting is '+' or '-' and an effect to switch on or off, or '=' or '@' and an
   assignment to a parameter or of a start, in the order given.
   returns  TOOL_OK or TOOL_USAGE, the message being printed */
int options_read(options *, int argc, char **argv);
/* shell_line.c: a line for a shell, "  nevh COMMAND SCENE" and the settings given.  A
   word that a shell would change is quoted. */
char *shell_line(const options *, const char *run, const char *scene);
char *shell_word(char *line, const char *word);
char *shell_option(char *line, const char *name, const char *value);
char *shell_number(char *line, const char *name, double value);
/* Notes the settings of --set and --start, a line each. */
void settings_notes(const options *, list *notes);

/* output.c: a file that is there when it is whole, or stdout. */
typedef struct {
    FILE *stream;
    char *name, *temporary;
    char *made; /* an empty file that stands under the name until then */
    int former; /* what stands there; open, and locked where `locks` */
    bool locks;
} output;
int output_open(output *, const char *name); /* NULL: stdout */
/* The same for a file that is closed before it is whole, and grows under its
   name: it is locked, and what is there stays until it is closed.
   who  "run": what is refused where another one has it locked */
int output_claim(output *, const char *name, const char *who);
/* Calls `note` when the first of the signals that end programs comes, unless it is
   ignored; one more ends the program, and so does the first where `note` is NULL.
   late  printed where the program ends since it took longer than a second after
         `note`: steps may have a million substeps; kept */
void signals_catch(void (*note)(int), const char *late);
void signal_catch(int number, void (*note)(int));
/* Sends the signal of a timer, ITIMER_REAL or ITIMER_PROF, after so many seconds; 0:
   never. */
void timer_start(int timer, double seconds);
/* Ends the program as that signal does. */
void signal_end(int number);
/* Calls `leave` where the program ends before it is taken back by NULL: with the
   number of the signal, or with 0 where memory is out.  It may call only what
   handlers of signals may. */
/* A child that is to end with this program, and all of its group; 0: it has ended. */
void output_child(pid_t);
bool file_is_regular(int file);
/* A file to read, or NULL where it is none: a pipe or a device may have no end. */
FILE *regular_open(const char *name);
/* All of a file, which is closed, and a 0 after it; NULL: it is none.
   size  out, or NULL */
char *file_read(FILE *, size_t *size);
void output_leave(void (*leave)(int number));
/* Checks that it can be opened, as far as that is known without changing it. To be
   called while none is open. */
int output_check(const char *name);
/* Renames, or, unless it is to be kept, removes.  Returns `status`, or
   TOOL_USAGE when writing failed. */
int output_close(output *, int status);

/* True if an output of the process could not be made or written. */
bool output_failed(void);
/* Opens what -o says, prints, closes. */
int output_page(const options *, const page *, int status);
void page_print(const page *, const options *, FILE *);
/* page_html.c: the page, and text with markup's characters written out. */
void page_html(const page *, FILE *);
void html_text(FILE *, const char *);

/* outputs.c */
/* Suffixes of side files: the state of nevh run, and what an array of
   nevh sweep was made from. */
#define STATE_ENDING      ".state"
#define ARRAY_TEXT_ENDING ".txt"
/* FILE.npy, or for task I of N (0: there are no tasks) FILE.I-of-N.npy. */
char *output_part(const char *file, uint64_t task, uint64_t tasks);
/* Checks that no option writes over the file of a scene, its C code, measured
   points, or the output of another option, whatever their names. */
int outputs_check(const options *, const nevh_scene *, const char *file);

/* scenes.c: scenes by file or name, changed as the options say. */
/* The value of what an option was given: a formula of parameters.
   returns  TOOL_OK, or TOOL_USAGE with the message printed */
int scene_number(nevh_scene *, const options *, const char *formula, double *);
/* Its message on stderr; TOOL_USAGE. */
int scene_report(const nevh_scene *, const options *);
/* returns  TOOL_OK, or TOOL_USAGE with the message printed and *scene NULL */
/* True of "period", "mean(x)". */
bool outcome_named(const char *text);
int scene_open(nevh_scene **scene, const options *);
int scene_open_named(nevh_scene **scene, const char *name, const options *);
/* The message that none is there. */
int scenes_missing(void);
/* Names of installed scenes, sorted; with their files when `files` is not
   NULL. */
void scenes_installed(list *names, list *files);
/* The file of an installed scene, or of "hard/NAME"; NULL when there is none. */
char *scene_file(const char *name);
/* The file of --data: here, or beside the installed scenes. */
char *data_file(const char *name);

/* The live page without a scene, beside this program or where it was configured
   to be.  Whether it is there is not known. */
char *page_kit(void);
/* The folder of the package for Python, and the library where it stands beside
   this program, or NULL. */
char *package_folder(void);
char *library_file(void);

#endif
