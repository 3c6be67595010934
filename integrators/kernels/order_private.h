/* nevh: order conditions of splittings and of Runge-Kutta methods.
   SPDX-License-Identifier: GPL-3.0-or-later

   A step of a splitting is the product of exp(w A) for its drifts and exp(w B) for
   its kicks in their turn, a series in the words over the letters A and B.  It is
   of order p if that series is the one of exp(A + B) up to degree p: in each word
   of k letters the coefficient is 1/k!.  A and B satisfy no relation in general;
   the coefficients at the Lyndon words of a degree decide, where the degrees below
   are fulfilled.

   Of a Runge-Kutta method each rooted tree gives a condition, sum_i b_i phi_i(t) =
   1/gamma(t) [J. C. Butcher, Coefficients for the study of Runge-Kutta integration
   processes, J. Austral. Math. Soc. 3 (1963) 185-201].

   Conditions hold if what is left is explained by the accuracy of the numbers. */
#ifndef NEVH_ORDER_PRIVATE_H
#define NEVH_ORDER_PRIVATE_H

#include <nevh/extend.h>
#include <stdbool.h>

/* The conditions of one degree. */
typedef struct {
    double
        excess; /* the most that one is off, in units of what the accuracy of the
                      numbers explains */
    size_t which; /* the first that fails, a word or a tree */
    long double value, due;
} nevh__conditions;

/* Kicks and drifts in turn. */
typedef struct {
    nevh_operation first;
    size_t count;
    const long double *weights;
} nevh__operations;

enum { NEVH__MOST_DEGREE = 11, NEVH__MOST_RELATED = 7 };
/* A word is its letters as bits behind a leading 1: A is 0, B is 1.
   quadratic  T is: [B,[B,[B,A]]] = 0, up to NEVH__MOST_RELATED without other
              relations
   digits     the relative accuracy of the weights
   found      degree + 1; element 0 is not used
   returns    false when memory is out */
bool nevh__words_check(const nevh__operations *, bool quadratic, size_t degree,
                       double digits, nevh__conditions found[]);
/* The sum that a word is, times what makes it one of plain products. */
void nevh__word_text(size_t word, nevh_operation first, nevh__conditions *,
                     char text[], size_t size);

enum { NEVH__MOST_TREE = 9, NEVH__TREES = 486 };
/* Children are earlier trees, from late to early. */
typedef struct {
    int order, children, child[NEVH__MOST_TREE];
    long double density;
} nevh__rooted;
typedef struct {
    int count, end[NEVH__MOST_TREE + 1]; /* end: of trees up to an order */
    nevh__rooted tree[NEVH__TREES];
} nevh__trees;
void nevh__trees_plant(nevh__trees *, int order);
/* The elementary weights of every stage, tree after tree.
   a      stages x stages, row by row
   above  sum_j a_ij phi_j of each: room for as many */
void nevh__trees_weigh(const nevh__trees *, size_t stages,
                       const long double a[], long double phi[],
                       long double above[]);
/* found: order + 1; element 0 is not used.  false when memory is out */
bool nevh__trees_check(const nevh__trees *, size_t stages,
                       const long double a[], const long double b[], int order,
                       double digits, nevh__conditions found[]);
void nevh__tree_text(const nevh__trees *, size_t which, char text[],
                     size_t size);

#endif
