/// \file report_support.h
/// What the tests of plots and of the report's pages share: a scene whose every text tries to be
/// code.
#ifndef SPHVERIFY_TESTS_REPORT_SUPPORT_H
#define SPHVERIFY_TESTS_REPORT_SUPPORT_H

#include "sphverify/report.h"
#include "support.h"

/// Would write a file `touched` if any of it were run by gnuplot or a shell.
#define NASTY                                                                                      \
    "'; system(\"touch touched\") # `touch touched` $(touch touched) \" \\ \n set output "         \
    "'touched'\n{/Symbol a}_b^2 %d @x <script>alert(1)</script> </title></svg> & | ]]> <!--"

/// A scene of two curves over h or Δx/h, run; labels as given.
struct stage {
    sphv_scene scene;
    sphv_curve curves[2];
    sphv_claim claims[2];
    sphv_kernel *kernel;
    sphv_scene_result *result;
    char *nasty;
};

void stage_make(struct stage *stage, sphv_abscissa abscissa, const char *text);
void stage_free(struct stage *stage);

/// A copy that the caller frees.
char *text_copy(const char *text);

/// How often a text holds a part.
size_t count(const char *text, const char *part);

bool have_gnuplot(void);

/// No file `touched` is here.
void assert_untouched(void);

#endif
