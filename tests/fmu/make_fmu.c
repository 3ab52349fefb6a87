/* make_fmu FILE.fmu BINARY.so 2|3 TOKEN [states] [derivatives] [fixed] [once] [other-platform] [no-binary] ...: pack a
 * model of model.h as an FMU. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zip.h>

static const struct {
  const char *name, *causality;
  int reference, derivative_of; /* -1: of none */
} reals[] = {{"mass", "parameter", V_MASS, -1},
             {"stiffness", "parameter", V_STIFFNESS, -1},
             {"damping", "parameter", V_DAMPING, -1},
             {"preload", "parameter", V_PRELOAD, -1},
             {"gravity", "parameter", V_GRAVITY, -1},
             {"inertia", "parameter", V_INERTIA, -1},
             {"arm", "parameter", V_ARM, -1},
             {"area", "parameter", V_AREA, -1},
             {"supply", "parameter", V_SUPPLY, -1},
             {"valve", "parameter", V_VALVE, -1},
             {"modulus", "parameter", V_MODULUS, -1},
             {"volume", "parameter", V_VOLUME, -1},
             {"f", "input", V_F, -1},
             {"m", "input", V_M, -1},
             {"fx", "input", V_FX, -1},
             {"fy", "input", V_FY, -1},
             {"mz", "input", V_MZ, -1},
             {"x", "output", V_X, -1},
             {"y", "output", V_Y, -1},
             {"vx", "output", V_VX, -1},
             {"vy", "output", V_VY, -1},
             {"ax", "output", V_AX, V_VX},
             {"ay", "output", V_AY, V_VY},
             {"phi", "output", V_PHI, -1},
             {"w", "output", V_W, -1},
             {"alpha", "output", V_ALPHA, V_W},
             {"pressure", "output", V_PRESSURE, -1},
             {"degrees", "output", V_DEGREES, -1}};
enum { NREAL = sizeof reals / sizeof reals[0] };

static int number_of(int reference) {
  for (int i = 0; i < NREAL; i++)
    if (reals[i].reference == reference)
      return i + 1;
  return 0;
}

static bool asked(char **words, const char *word) {
  for (; *words; words++)
    if (strcmp(*words, word) == 0)
      return true;
  return false;
}

/* Variables; `slopes`: accelerations are told to be derivatives. */
static void write_variables(FILE *out, int version, bool slopes) {
  fprintf(out, "<ModelVariables>\n");
  for (int i = 0; i < NREAL; i++) {
    char derivative[64] = "";
    const int of = reals[i].derivative_of;
    if (of >= 0 && slopes)
      snprintf(derivative, sizeof derivative, " derivative=\"%d\"", version == 2 ? number_of(of) : of);
    if (version == 2)
      fprintf(out, "<ScalarVariable name=\"%s\" valueReference=\"%d\" causality=\"%s\"><Real%s/></ScalarVariable>\n",
              reals[i].name, reals[i].reference, reals[i].causality, derivative);
    else
      fprintf(out, "<Float64 name=\"%s\" valueReference=\"%d\" causality=\"%s\"%s/>\n", reals[i].name,
              reals[i].reference, reals[i].causality, derivative);
  }
  if (version == 2)
    fprintf(out,
            "<ScalarVariable name=\"count\" valueReference=\"%d\" causality=\"parameter\"><Integer/></ScalarVariable>"
            "<ScalarVariable name=\"on\" valueReference=\"%d\" causality=\"parameter\"><Boolean/></ScalarVariable>"
            "<ScalarVariable name=\"text\" valueReference=\"%d\" causality=\"parameter\"><String/></ScalarVariable>\n",
            V_COUNT, V_SWITCH, V_TEXT);
  else
    fprintf(
        out,
        "<Int32 name=\"count\" valueReference=\"%d\" causality=\"parameter\"/>"
        "<Boolean name=\"on\" valueReference=\"%d\" causality=\"parameter\"/>"
        "<String name=\"text\" valueReference=\"%d\" causality=\"parameter\"/>"
        "<Float64 name=\"force\" valueReference=\"%d\" causality=\"input\"><Dimension start=\"3\"/></Float64>"
        "<Float64 name=\"place\" valueReference=\"%d\" causality=\"output\"><Dimension start=\"3\"/></Float64>"
        "<Float64 name=\"velocity\" valueReference=\"%d\" causality=\"output\"><Dimension start=\"3\"/></Float64>\n",
        V_COUNT, V_SWITCH, V_TEXT, V_FORCE3, V_PLACE3, V_VELOCITY3);
  fprintf(out, "</ModelVariables>\n<ModelStructure/>\n");
}

static char *describe(int version, const char *token, char **words, size_t *size) {
  char *text = NULL;
  FILE *out = open_memstream(&text, size);
  fprintf(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"%s\" modelName=\"%s\" ",
          asked(words, "version1") ? "1.0"
          : version == 2           ? "2.0"
                                   : "3.0",
          token);
  fprintf(out, "%s=\"%s\">\n", version == 2 ? "guid" : "instantiationToken",
          asked(words, "other-token") ? "somebody's" : token);
  fprintf(out,
          "<%s modelIdentifier=\"%s\" %s=\"%s\" %s=\"%s\" canHandleVariableCommunicationStepSize=\"%s\" "
          "canBeInstantiatedOnlyOncePerProcess=\"%s\"/>\n",
          asked(words, "exchange") ? "ModelExchange" : "CoSimulation",
          asked(words, "identifier") ? "../model" : "model",
          version == 2 ? "canGetAndSetFMUstate" : "canGetAndSetFMUState", asked(words, "states") ? "true" : "false",
          version == 2 ? "providesDirectionalDerivative" : "providesDirectionalDerivatives",
          asked(words, "derivatives") ? "true" : "false", asked(words, "fixed") ? "false" : "true",
          asked(words, "once") ? "true" : "false");
  write_variables(out, version, !asked(words, "no-slopes"));
  if (!asked(words, "broken"))
    fprintf(out, "</fmiModelDescription>\n");
  fclose(out);
  return text;
}

static void add(zip_t *zip, const char *name, zip_source_t *source) {
  if (!source || zip_file_add(zip, name, source, ZIP_FL_ENC_UTF_8) < 0)
    exit(1);
}

int main(int argc, char **argv) {
  if (argc < 5)
    return 2;
  const char *file = argv[1], *binary = argv[2], *token = argv[4];
  const int version = atoi(argv[3]);
  char **words = argv + 5, name[128];
  size_t size = 0;
  char *text = describe(version, token, words, &size);
  zip_t *zip = zip_open(file, ZIP_CREATE | ZIP_TRUNCATE, NULL);
  if (!zip)
    return 1;
  if (!asked(words, "no-description"))
    add(zip, "modelDescription.xml", zip_source_buffer(zip, text, size, 0));
  if (asked(words, "escape"))
    add(zip, "../escaped.txt", zip_source_buffer(zip, "x", 1, 0));
  snprintf(name, sizeof name, "binaries/%s/model.so",
           asked(words, "other-platform") ? "win64"
           : version == 2                 ? "linux64"
                                          : "x86_64-linux");
  if (!asked(words, "no-binary"))
    add(zip, name, zip_source_file(zip, binary, 0, -1));
  const int status = zip_close(zip) == 0 ? 0 : 1;
  free(text);
  return status;
}
