/* Reads problems with libfclib, the reference library (Debian: libfclib-dev), and says what it finds:

     gcc with_libfclib.c -o with_libfclib $(pkg-config --cflags --libs fclib hdf5)
     ./with_libfclib FILE.hdf5...                     sizes, residual of the solution
     ./with_libfclib FILE.hdf5 --copy OUT.hdf5        writes the problem through libfclib  */
#include <fclib.h>
#include <hdf5.h>
#include <stdio.h>
#include <string.h>

/* Whether a file has a group; asked first, because libfclib ends the program where one is missing. */
static int has(const char *path, const char *group) {
  hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  int found = file >= 0 && H5Lexists(file, group, H5P_DEFAULT) > 0;
  if (file >= 0) H5Fclose(file);
  return found;
}

static void matrix(const char *name, struct fclib_matrix *a) {
  printf(" %s %d x %d nz %d nzmax %d", name, a->m, a->n, a->nz, a->nzmax);
}

static int one(const char *path, const char *copy) {
  struct fclib_solution *solution = has(path, "/solution") ? fclib_read_solution(path) : NULL;
  printf("%s:", path);
  if (has(path, "/fclib_local")) {
    struct fclib_local *p = fclib_read_local(path);
    matrix("W", p->W);
    if (p->V) matrix("V", p->V);
    /* Its merit function is written for space alone, and solutions without multipliers. */
    if (solution && p->spacedim == 3 && !p->V) printf(" merit %.1e", fclib_merit_local(p, MERIT_1, solution));
    if (copy && !fclib_write_local(p, copy)) return 1;
  } else if (has(path, "/fclib_global")) {
    struct fclib_global *p = fclib_read_global(path);
    matrix("M", p->M), matrix("H", p->H);
    if (copy && !fclib_write_global(p, copy)) return 1;
  } else {
    puts(" no problem that libfclib knows");
    return 1;
  }
  if (copy && solution && !fclib_write_solution(solution, copy)) return 1;
  puts("");
  return 0;
}

int main(int count, char **names) {
  int failed = count < 2;
  if (count == 4 && !strcmp(names[2], "--copy")) return one(names[1], names[3]);
  for (int k = 1; k < count; k++) failed |= one(names[k], NULL);
  return failed;
}
