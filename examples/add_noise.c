/* Makes measured data of computed ones: reads the CSV of nevh run, keeps t and
   the columns that are named, and adds normal noise of one standard deviation,
   with a seed, so that the same command makes the same data.

       nevh run pendulum-filmed | add_noise 0.004 1 x y

   SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 100, LENGTH = 1 << 14 };

/* splitmix64; in (0, 1). */
static double uniform(uint64_t *seed) {
    uint64_t z = *seed += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return ((double)((z ^ z >> 31) >> 11) + 0.5) * 0x1p-53;
}

/* The method of Box and Muller. */
static double normal(uint64_t *seed) {
    static const double turn = 6.283185307179586;
    double size = sqrt(-2 * log(uniform(seed)));
    return size * cos(turn * uniform(seed));
}

/* The fields between commas; returns how many. */
static int split(char *line, char *field[MOST]) {
    int count = 0;
    for (char *at = strtok(line, ",\n"); at && count < MOST;
         at = strtok(NULL, ",\n"))
        field[count++] = at;
    return count;
}

/* Without arguments: what the noise is like, of standard deviation 1. */
static int explain(int argc) {
    uint64_t seed = 1;
    puts("usage: nevh run SCENE | add_noise SIGMA SEED NAME...");
    if (argc > 1)
        return EXIT_FAILURE;
    puts("\n  draws     mean      rms");
    for (int count = 100; count <= 1000000; count *= 100) {
        double sum = 0, squares = 0;
        for (int i = 0; i < count; i++) {
            double x = normal(&seed);
            sum += x;
            squares += x * x;
        }
        printf("%7d %8.4f %8.4f\n", count, sum / count, sqrt(squares / count));
    }
    return EXIT_SUCCESS;
}

int main(int argc, char **argv) {
    char line[LENGTH], *field[MOST];
    int place[MOST] = {0}, columns = argc - 3, known = 0;
    if (argc < 4 || columns > MOST)
        return explain(argc);
    double sigma = atof(argv[1]);
    int places = sigma > 0 ? (int)fmax(0, 4 - floor(log10(sigma))) : 17;
    uint64_t seed = strtoull(argv[2], NULL, 10) * 0x2545f4914f6cdd1du;
    while (fgets(line, sizeof line, stdin)) {
        if (*line == '#')
            continue;
        int count = split(line, field);
        if (!known) {
            for (int k = 0; k < columns; k++) {
                while (place[k] < count &&
                       strcmp(field[place[k]], argv[k + 3]) != 0)
                    place[k]++;
                if (place[k] == count) {
                    fprintf(stderr, "there is no column %s\n", argv[k + 3]);
                    return EXIT_FAILURE;
                }
                printf("%s%s", k ? "," : "t,", argv[k + 3]);
            }
            known = 1;
        } else {
            printf("%s", field[0]);
            for (int k = 0; k < columns; k++)
                printf(",%.*f", places,
                       atof(field[place[k]]) + sigma * normal(&seed));
        }
        puts("");
    }
    return known ? EXIT_SUCCESS : EXIT_FAILURE;
}
