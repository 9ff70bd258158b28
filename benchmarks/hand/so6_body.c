/* so_body.h tells the equations. */
#define N 6
#include "so_body.h"
