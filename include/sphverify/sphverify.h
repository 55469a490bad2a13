/// \file sphverify.h
/// Everything the library offers.
#ifndef SPHVERIFY_SPHVERIFY_H
#define SPHVERIFY_SPHVERIFY_H

#include "sphverify/compare.h"
#include "sphverify/kernel.h"
#include "sphverify/measure.h"
#include "sphverify/number.h"
#include "sphverify/status.h"
#include "sphverify/theory.h"

#endif
