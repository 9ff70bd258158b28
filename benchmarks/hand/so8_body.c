/* so_body.h tells the equations. */
#define N 8
#include "so_body.h"
