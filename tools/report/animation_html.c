/* nevh report: a moving picture as SVG, with a script that moves it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "animation_private.h"
#include "plot/plot.h"
#include "report_private.h"
#include <math.h>
#include <string.h>

/* Units of the picture. */
enum {
    WIDTH = 2000,
    PANEL = 960,
    LEAST_HEIGHT = 420,
    HEAD = 80,
    STRIP = 240,
    FOOT = 70,
    FAR = 9999,
    TRAIL = 24 /* steps */
};
static const char script[] =
    "(function(){var given=document.currentScript.previousElementSibling,\n"
    "f=given.previousElementSibling,\n"
    "all=function(e,s){return[].slice.call(e.querySelectorAll(s))},\n"
    "d=JSON.parse(given.textContent),n=d.steps,at=n,timer=0,\n"
    "still=matchMedia('(prefers-reduced-motion: reduce)'),\n"
    "box=all(f,'.controls')[0],play=all(f,'button')[0],bar=all(f,'input')[0],\n"
    "stamp=all(f,'.stamp')[0],cursor=all(f,'.cursor')[0];\n"
    "function put(e,names,a,o){names.forEach(function(x,i){"
    "e.setAttribute(x,a[o+i])})}\n"
    "function show(k){at=k;bar.value=k;all(f,'.orbit').forEach("
    "function(g,i){\n"
    "var a=d.places[i],m=d.columns,l=Math.min(k,a.length/m-1),o=l*m,"
    "b=o+4*d.rods;\n"
    "all(g,'line').forEach(function(e,j){put(e,['x1','y1','x2','y2'],a,o+4*j)})"
    ";\n"
    "all(g,'circle').forEach(function(e,j){put(e,['cx','cy'],a,b+2*j)});\n"
    "all(g,'text').forEach(function(e,j){put(e,['x','y'],a,b+2*j)});\n"
    "all(g,'polyline').forEach(function(e,j){var s='';"
    "for(var h=Math.max(0,l-d.trail);h<=l;h++)"
    "s+=a[h*m+4*d.rods+2*j]+','+a[h*m+4*d.rods+2*j+1]+' ';"
    "e.setAttribute('points',s)});\n"
    "all(g,'path').forEach(function(e,j){var s='M';"
    "for(var h=0;h<=l;h++)"
    "s+=a[h*m+4*d.rods+2*j]+','+a[h*m+4*d.rods+2*j+1]+' ';"
    "e.setAttribute('d',s)});\n"
    "all(f,'.error')[i].textContent=d.errors[i][l]+' %'});\n"
    "var x=d.width*k/n;cursor.setAttribute('x1',x);"
    "cursor.setAttribute('x2',x);\n"
    "stamp.textContent='step '+k+', t = '+(d.start+k*d.dt).toFixed(d.digits)"
    "}\n"
    "function stop(){clearInterval(timer);timer=0;play.textContent='Play'}\n"
    "play.onclick=function(){if(timer)return stop();if(at>=n)show(0);"
    "play.textContent='Pause';\n"
    "timer=setInterval(function(){if(at>=n)stop();else show(at+1)},40)};\n"
    "bar.oninput=function(){stop();show(+bar.value)};\n"
    "function mind(){stop();play.hidden=still.matches}\n"
    "if(still.addEventListener)still.addEventListener('change',mind);\n"
    "mind();box.hidden=false})();\n";

/* The map from coordinates to a panel. */
typedef struct {
    double x, y, scale; /* of its upper left corner */
    int height;
} view;

static view view_of(const recording *r) {
    static const double room = 0.12;
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < r->frames * r->columns; i++) {
        low[i % 2] = fmin(low[i % 2], r->place[i]);
        high[i % 2] = fmax(high[i % 2], r->place[i]);
    }
    double across = high[0] - low[0], up = high[1] - low[1];
    double more = room * fmax(across, up);
    more = more > 0 ? more : 1;
    across += 2 * more, up += 2 * more;
    double height = fmin(fmax(PANEL * up / across, LEAST_HEIGHT), PANEL);
    double scale = fmin(PANEL / across, height / up);
    return (view){(low[0] + high[0]) / 2 - PANEL / scale / 2,
                  (low[1] + high[1]) / 2 + height / scale / 2, scale,
                  (int)height};
}

static int across(const view *v, double x) {
    return (int)fmin(fmax(round((x - v->x) * v->scale), -FAR), FAR);
}

static int down(const view *v, double y) {
    return (int)fmin(fmax(round((v->y - y) * v->scale), -FAR), FAR);
}

static const double *frame(const recording *r, size_t i) {
    return r->place + (i < r->frames ? i : r->frames - 1) * r->columns;
}

static const char *colour_of(const recording *r) {
    return plot_colour_of(plot_look_of_integrator(r->integrator));
}

/* Grey where the bob stays. */
static const char *colour_of_bob(const animation *f, const recording *r,
                                 size_t bob) {
    size_t at = 4 * f->rods + 2 * bob;
    for (size_t i = 1; i < r->frames; i++)
        if (frame(r, i)[at] != frame(r, 0)[at] ||
            frame(r, i)[at + 1] != frame(r, 0)[at + 1])
            return colour_of(r);
    return "#999";
}

static void put_places_of(const animation *f, const recording *r, const view *v,
                          size_t bob, size_t first, FILE *to) {
    for (size_t i = first; i < r->frames; i++) {
        const double *at = frame(r, i) + 4 * f->rods + 2 * bob;
        fprintf(to, "%d,%d ", across(v, at[0]), down(v, at[1]));
    }
    fputs("\"/>\n", to);
}

/* The whole way faintly, the last steps more. */
static void put_trail(const animation *f, const recording *r, const view *v,
                      size_t bob, FILE *to) {
    const char *colour = colour_of_bob(f, r, bob);
    size_t last = r->frames - 1;
    fprintf(to,
            "<path fill=\"none\" stroke=\"%s\" stroke-opacity=\".25\" "
            "stroke-width=\"3\" d=\"M",
            colour);
    put_places_of(f, r, v, bob, 0, to);
    fprintf(to,
            "<polyline fill=\"none\" stroke=\"%s\" stroke-opacity=\".5\" "
            "points=\"",
            colour);
    put_places_of(f, r, v, bob, last > TRAIL ? last - TRAIL : 0, to);
}

/* Above the bobs, unless these are many or a sole one without a name; at: the first
   bob's place. */
static void put_names(const animation *f, const double *at, const view *v,
                      FILE *to) {
    enum { FEW = 8 };
    for (size_t i = 0; i < f->bobs && f->bobs <= FEW; i++, at += 2) {
        char *name = plot_bob_name(f->plan->scene, i);
        if (!name)
            return;
        fprintf(to,
                "<text text-anchor=\"middle\" dy=\"-36\" stroke=\"none\" "
                "fill=\"#555\" x=\"%d\" y=\"%d\">",
                across(v, at[0]), down(v, at[1]));
        html_text(to, name);
        fputs("</text>\n", to);
    }
}

/* At the last step. */
static void put_orbit(const animation *f, const recording *r, const view *v,
                      FILE *to) {
    const double *at = frame(r, f->most);
    fputs("<g class=\"orbit\" stroke-width=\"5\">\n", to);
    for (size_t i = 0; i < f->bobs; i++)
        put_trail(f, r, v, i, to);
    for (size_t i = 0; i < f->rods; i++, at += 4)
        fprintf(to,
                "<line stroke=\"#777\" stroke-width=\"10\" x1=\"%d\" "
                "y1=\"%d\" x2=\"%d\" y2=\"%d\"/>\n",
                across(v, at[0]), down(v, at[1]), across(v, at[2]),
                down(v, at[3]));
    for (size_t i = 0; i < f->bobs; i++, at += 2)
        fprintf(to, "<circle r=\"%d\" fill=\"%s\" cx=\"%d\" cy=\"%d\"/>\n",
                i < 4 ? 26 - 4 * (int)i : 12, colour_of_bob(f, r, i),
                across(v, at[0]), down(v, at[1]));
    put_names(f, at - 2 * f->bobs, v, to);
    fputs("</g>\n", to);
}

static void put_panel(const animation *f, size_t i, const view *v, FILE *to) {
    const recording *r = &f->recording[i];
    int left = i ? WIDTH - PANEL : 0;
    fprintf(to,
            "<text x=\"%d\" y=\"58\" fill=\"%s\">%s, error <tspan "
            "class=\"error\">%.2g %%</tspan></text>\n"
            "<svg x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" viewBox=\"0 0 "
            "%d %d\">\n<rect width=\"%d\" height=\"%d\" fill=\"#f4f4f4\"/>\n",
            left, colour_of(r), r->integrator, 100 * r->error[r->frames - 1],
            left, HEAD, PANEL, v->height, PANEL, v->height, PANEL, v->height);
    put_orbit(f, r, v, to);
    fputs("</svg>\n", to);
}

/* Errors of both over the steps. */
static void put_strip(const animation *f, int top, FILE *to) {
    double low = 0, high = 0;
    for (int i = 0; i < 2; i++)
        for (size_t k = 0; k < f->recording[i].frames; k++) {
            low = fmin(low, f->recording[i].error[k]);
            high = fmax(high, f->recording[i].error[k]);
        }
    double scale = STRIP / (high > low ? high - low : 1);
    fprintf(to,
            "<text x=\"0\" y=\"%d\">Energy error of both over the steps, "
            "%.2g %% to %.2g %%</text>\n<svg x=\"0\" y=\"%d\" width=\"%d\" "
            "height=\"%d\" viewBox=\"0 -4 %d %d\">\n<path stroke=\"#999\" "
            "stroke-width=\"2\" d=\"M0,%.0fH%d\"/>\n",
            top + 60, 100 * low, 100 * high, top + HEAD, WIDTH, STRIP + 8,
            WIDTH, STRIP + 8, high * scale, WIDTH);
    for (int i = 0; i < 2; i++) {
        fprintf(to,
                "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"5\" "
                "points=\"",
                colour_of(&f->recording[i]));
        for (size_t k = 0; k < f->recording[i].frames; k++)
            fprintf(to, "%.0f,%.0f ", (double)(WIDTH * k) / (double)f->most,
                    (high - f->recording[i].error[k]) * scale);
        fputs("\"/>\n", to);
    }
    fprintf(to,
            "<line class=\"cursor\" stroke=\"#000\" stroke-width=\"3\" "
            "x1=\"%d\" x2=\"%d\" y1=\"0\" y2=\"%d\"/>\n</svg>\n",
            WIDTH, WIDTH, STRIP);
}

static void put_places(const recording *r, const view *v, FILE *to) {
    for (size_t i = 0; i < r->frames * r->columns; i++)
        fprintf(to, "%s%d", i ? "," : "[",
                i % 2 ? down(v, r->place[i]) : across(v, r->place[i]));
    fputs("]", to);
}

static void put_errors(const recording *r, FILE *to) {
    for (size_t i = 0; i < r->frames; i++)
        fprintf(to, "%s%.2g", i ? "," : "[", 100 * r->error[i]);
    fputs("]", to);
}

/* Digits after the point that distinguish steps. */
static int digits_of(const animation *f) {
    return (int)fmin(fmax(0, 1 - floor(log10(f->dt))), 12);
}

static void put_data(const animation *f, const view *v, FILE *to) {
    fprintf(to,
            "<script type=\"application/json\">{\"steps\":%zu,\"dt\":%.17g,"
            "\"start\":%.17g,\"digits\":%d,\"rods\":%zu,\"columns\":%zu,"
            "\"trail\":%d,\"width\":%d,\"places\":[",
            f->most, f->dt, f->plan->run->t_start, digits_of(f), f->rods,
            f->recording->columns, TRAIL, WIDTH);
    put_places(&f->recording[0], v, to);
    fputs(",\n", to);
    put_places(&f->recording[1], v, to);
    fputs("],\n\"errors\":[", to);
    put_errors(&f->recording[0], to);
    fputs(",\n", to);
    put_errors(&f->recording[1], to);
    fputs("]}</script>\n", to);
}

static double worst(const recording *r) {
    double most = 0;
    for (size_t i = 0; i < r->frames; i++)
        most = fmax(most, fabs(r->error[i]));
    return 100 * most;
}

static void put_words(const animation *f, FILE *to) {
    const recording *rk4 = &f->recording[1];
    const char *unit = nevh_scene_label(f->plan->scene, "t");
    double end = 100 * rk4->error[rk4->frames - 1];
    fprintf(to, "<p>%s and rk4 take %zu steps of %.3g%s",
            f->recording->integrator, f->most, f->dt, *unit ? " " : "");
    html_text(to, unit);
    if (rk4->frames <= f->most)
        fprintf(to, "; rk4 ends at step %zu.", rk4->frames - 1);
    else if (fabs(end) >= 1)
        fprintf(to, ". rk4 has then %s %.2g %% of the energy scale.",
                end < 0 ? "lost" : "gained", fabs(end));
    else
        fprintf(to, ". The energy error of rk4 stays within %.2g %%.",
                worst(rk4));
    fprintf(to, " The energy error of %s stays within %.2g %%.%s</p>\n",
            f->recording->integrator, worst(f->recording),
            f->shows_drift
                ? ""
                : " Of the steps that were tried, rk4 has at none an error "
                  "that is large while that of the other is small; these "
                  "are the longest of the scene.");
}

static void put_caption(const animation *f, FILE *to) {
    const char *unit = nevh_scene_label(f->plan->scene, "t");
    double end = f->plan->run->t_start + (double)f->most * f->dt;
    fprintf(to, "<figcaption><span class=\"stamp\">step %zu, t = %.*f</span> ",
            f->most, digits_of(f), end);
    html_text(to, unit);
    fprintf(to,
            "\n<span class=\"controls\" hidden><button "
            "type=\"button\">Play</button> <input type=\"range\" min=\"0\" "
            "max=\"%zu\" value=\"%zu\" aria-label=\"step\"></span>"
            "</figcaption>\n</figure>\n",
            f->most, f->most);
}

void animation_html(const animation *f, FILE *to) {
    view v = view_of(&f->recording[0]);
    int top = HEAD + v.height;
    put_words(f, to);
    fprintf(to,
            "<figure>\n<svg role=\"img\" viewBox=\"0 0 %d "
            "%d\" font-family=\"sans-serif\" font-size=\"60\">\n<title>The "
            "motion by %s and by rk4</title>\n<desc>Left: %s. Right: rk4. "
            "Below: the energy errors of both, %s blue, rk4 orange. Without a "
            "script, and before it plays, the picture shows step %zu.</desc>\n",
            WIDTH, top + HEAD + STRIP + FOOT - 50, f->recording->integrator,
            f->recording->integrator, f->recording->integrator, f->most);
    put_panel(f, 0, &v, to);
    put_panel(f, 1, &v, to);
    put_strip(f, top, to);
    fputs("</svg>\n", to);
    put_caption(f, to);
    put_data(f, &v, to);
    fprintf(to, "<script>\n%s</script>\n", script);
}
