/* Writes the reference of the scene, docs/scene.md, from the texts, units and defaults of scenarios/scene.schema.json.
 *
 *   write_scene_reference SCHEMA PAGE          write the page
 *   write_scene_reference --check SCHEMA PAGE  exit status 1 when the page is not what the schema gives
 *
 * Beside JSON Schema's own words a key may have x-unit, x-default (in words, where the default is no constant) and
 * x-values (what each value of a choice does). Definitions that are used more than once stand in a part of their own.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <jansson.h>

#include <ctype.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 120 };

static const json_t *schema;
static FILE *page;

/* ---- text ---- */

/* columns of the first n bytes of UTF-8 text */
static int columns(const char *text, size_t n) {
  int count = 0;
  for (size_t i = 0; i < n; i++)
    count += (text[i] & 0xC0) != 0x80;
  return count;
}

/* Length of the word at the start of text: up to a blank that is not in backquotes nor in a link's text. */
static size_t word(const char *text) {
  bool code = false, link = false;
  size_t n = 0;
  for (; text[n] && (text[n] != ' ' || code || link); n++) {
    if (text[n] == '`')
      code = !code;
    else if (text[n] == '[' && !code)
      link = strchr(text + n, ']') && strchr(text + n, ']')[1] == '(';
    else if (text[n] == ')')
      link = false;
  }
  return n;
}

/* Print text in lines of at most COLUMNS, the first after `first`, the others after `rest`. A line never begins with
 * what Markdown takes for a list or a heading. */
static void wrap(const char *first, const char *rest, const char *text) {
  fputs(first, page);
  int at = (int)strlen(first);
  for (bool begun = false; *text; begun = true) {
    size_t n = word(text);
    int wide = columns(text, n);
    bool mark = strchr("-+*#=>|", text[0]) || (isdigit((unsigned char)text[0]) && strchr(".)", text[n - 1]));
    if (begun && at + 1 + wide > COLUMNS && !mark) {
      fprintf(page, "\n%s", rest);
      at = (int)strlen(rest);
    } else if (begun) {
      fputc(' ', page);
      at++;
    }
    fwrite(text, 1, n, page);
    at += wide;
    text += n;
    text += *text == ' ';
  }
  fputc('\n', page);
}

/* ---- a text that grows ---- */

typedef struct {
  char text[8192];
} buffer;

__attribute__((format(printf, 2, 3))) static void add(buffer *b, const char *format, ...) {
  size_t n = strlen(b->text);
  va_list args;
  va_start(args, format);
  int more = vsnprintf(b->text + n, sizeof b->text - n, format, args);
  va_end(args);
  if (more < 0 || (size_t)more >= sizeof b->text - n) {
    fprintf(stderr, "write_scene_reference: a text of the schema is too long: %.60s ...\n", b->text);
    exit(EXIT_FAILURE);
  }
}

static void add_json(buffer *b, const json_t *value) {
  char *text = json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(12));
  if (text)
    add(b, "`%s`", text);
  free(text);
}

static const char *string(const json_t *node, const char *key) {
  return json_string_value(json_object_get(node, key));
}

/* Is a string of this node an expression? Numbers may be such everywhere, which is said once, at the head. */
static bool takes_expression(const json_t *node) {
  const char *pattern = string(node, "pattern");
  return pattern && strcmp(pattern, "^=") == 0;
}

/* The type of a node, NULL: none, or several. */
static const char *type_of(const json_t *node) {
  const json_t *type = json_object_get(node, "type");
  const bool number = takes_expression(node) && json_array_size(type) == 2;
  return json_string_value(number ? json_array_get(type, 0) : type);
}

/* ---- definitions ---- */

/* the name of the definition that a node refers to, NULL: none */
static const char *reference(const json_t *node) {
  const char *ref = string(node, "$ref");
  return ref ? strrchr(ref, '/') + 1 : NULL;
}

static const json_t *resolve(const json_t *node) {
  const json_t *own = json_object_get(node, "else"); /* a section of tandem's own solver, not of another's */
  node = own ? own : node;
  const char *name = reference(node);
  return name ? json_object_get(json_object_get(schema, "definitions"), name) : node;
}

static int count_references(const json_t *node, const char *name) {
  int count = 0;
  const char *key;
  size_t i;
  json_t *value;
  if (json_is_object(node)) {
    const char *own = reference(node);
    count += own && strcmp(own, name) == 0;
    json_object_foreach((json_t *)node, key, value) {
      count += count_references(value, name);
    }
  }
  json_array_foreach(node, i, value) {
    count += count_references(value, name);
  }
  return count;
}

/* Has a definition a part of its own? Those with a text that are used more than once. */
static bool is_shared(const char *name) {
  const json_t *definition = json_object_get(json_object_get(schema, "definitions"), name);
  if (strcmp(name, "condition") == 0)
    return false; /* `if` */
  return json_object_get(definition, "description") && count_references(schema, name) > 1;
}

/* the object with keys of its own that a node is, or is a list of, or may be; NULL: none, or it is shared */
static const json_t *object_of(const json_t *node) {
  if (reference(node) && is_shared(reference(node)))
    return NULL;
  node = resolve(node);
  if (json_object_get(node, "properties"))
    return node;
  if (json_object_get(node, "items"))
    return object_of(json_object_get(node, "items"));
  size_t i;
  json_t *choice;
  json_array_foreach(json_object_get(node, "oneOf"), i, choice) {
    if (object_of(choice))
      return object_of(choice);
  }
  return NULL;
}

/* GitHub's anchor of a heading */
static void add_anchor(buffer *b, const char *heading) {
  for (const char *c = heading; *c; c++)
    if (isalnum((unsigned char)*c) || *c == '_' || *c == '-')
      add(b, "%c", tolower((unsigned char)*c));
}

/* ---- what a value may be ---- */

static void add_type(buffer *b, const json_t *node, const char *path);

static void add_choices(buffer *b, const json_t *list, const char *path) {
  size_t i;
  json_t *choice;
  json_array_foreach(list, i, choice) {
    const char *name = reference(choice);
    if (name && strcmp(name, "expression") == 0)
      continue; /* said once, at the head */
    add(b, "%s", i ? " or " : "");
    if (json_is_object(choice))
      add_type(b, choice, path);
    else
      add(b, "%s", json_string_value(choice));
  }
}

static void add_values(buffer *b, const json_t *list) {
  size_t i;
  json_t *value;
  json_array_foreach(list, i, value) {
    add(b, "%s", i ? ", " : "");
    add_json(b, value);
  }
}

static void add_number(buffer *b, const json_t *node, const char *what) {
  static const struct {
    const char *key, *sign;
  } limits[] = {{"minimum", "≥"}, {"exclusiveMinimum", ">"}, {"maximum", "≤"}, {"exclusiveMaximum", "<"}};
  add(b, "%s", what);
  bool begun = false;
  for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
    const json_t *limit = json_object_get(node, limits[i].key);
    if (limit)
      add(b, "%s%s %.6g", begun ? ", " : " ", limits[i].sign, json_number_value(limit));
    begun = begun || limit;
  }
}

static void add_list(buffer *b, const json_t *node, const char *path) {
  const json_t *least = json_object_get(node, "minItems"), *most = json_object_get(node, "maxItems");
  add(b, "list of ");
  if (least && most && json_integer_value(least) == json_integer_value(most))
    add(b, "%lld ", (long long)json_integer_value(least));
  else if (least && most)
    add(b, "%lld to %lld ", (long long)json_integer_value(least), (long long)json_integer_value(most));
  else if (most)
    add(b, "at most %lld ", (long long)json_integer_value(most));
  const json_t *items = resolve(json_object_get(node, "items"));
  const char *type = type_of(items), *name = reference(json_object_get(node, "items"));
  if (json_object_get(items, "properties") && name && is_shared(name))
    add(b, "objects: [%s](#%s)", name, name);
  else if (json_object_get(items, "properties"))
    add(b, "[objects](#"), add_anchor(b, path), add(b, ")");
  else if (type && strcmp(type, "number") == 0)
    add_number(b, items, "numbers");
  else if (type && strcmp(type, "string") == 0)
    add(b, "names");
  else if (type && strcmp(type, "array") == 0) {
    add(b, "lists: ");
    add_list(b, items, path);
  } else {
    add(b, "entries: ");
    add_type(b, json_object_get(node, "items"), path);
  }
}

/* What a node may be, in words; path: of its own part, where it has one. */
static void add_type(buffer *b, const json_t *node, const char *path) {
  const char *name = reference(node);
  if (name && is_shared(name)) {
    add(b, "[%s](#%s)", name, name);
    return;
  }
  node = resolve(node);
  const json_t *type = json_object_get(node, "type");
  const char *word_of_type = type_of(node);
  if (json_object_get(node, "properties"))
    add(b, "[object](#"), add_anchor(b, path), add(b, ")");
  else if (json_object_get(node, "enum"))
    add_values(b, json_object_get(node, "enum"));
  else if (json_object_get(node, "const"))
    add_json(b, json_object_get(node, "const"));
  else if (json_object_get(node, "oneOf"))
    add_choices(b, json_object_get(node, "oneOf"), path);
  else if (json_object_get(node, "anyOf"))
    add_choices(b, json_object_get(node, "anyOf"), path);
  else if (!word_of_type && json_is_array(type)) {
    json_t *types = json_copy((json_t *)type);
    if (takes_expression(node))
      json_array_remove(types, json_array_size(types) - 1); /* "string" */
    add_choices(b, types, path);
    json_decref(types);
  } else if (!word_of_type)
    add(b, "see the text");
  else if (strcmp(word_of_type, "array") == 0)
    add_list(b, node, path);
  else if (strcmp(word_of_type, "integer") == 0)
    add_number(b, node, "whole number");
  else if (strcmp(word_of_type, "number") == 0)
    add_number(b, node, "number");
  else if (strcmp(word_of_type, "boolean") == 0)
    add(b, "true or false");
  else
    add(b, "%s", word_of_type);
}

/* ---- parts ---- */

static bool is_required(const json_t *object, const char *key) {
  size_t i;
  json_t *name;
  json_array_foreach(json_object_get(object, "required"), i, name) {
    if (strcmp(json_string_value(name), key) == 0)
      return true;
  }
  return false;
}

static const char *text_of(const json_t *node) {
  const char *text = string(node, "description");
  return text ? text : string(resolve(node), "description");
}

/* One key: its name, unit, what it may be, default and meaning, and what each value of a choice does. */
static void write_key(const json_t *object, const char *path, const char *key, const json_t *node) {
  buffer b = {""};
  const char *unit = string(node, "x-unit"), *words = string(node, "x-default");
  const json_t *constant = json_object_get(node, "default"), *values = json_object_get(node, "x-values");
  add(&b, "`%s`", key);
  if (unit)
    add(&b, " [%s]", unit);
  add(&b, " (");
  if (values && json_object_get(resolve(node), "enum"))
    add(&b, "choice");
  else
    add_type(&b, node, path);
  if (is_required(object, key))
    add(&b, "; **required**");
  else if (words)
    add(&b, "; %s%s", strncmp(words, "required", 8) == 0 ? "" : "default: ", words);
  else if (constant) {
    add(&b, "; default: ");
    add_json(&b, constant);
  }
  add(&b, "): %s", text_of(node) ? text_of(node) : "");
  wrap("- ", "  ", b.text);
  const char *value;
  json_t *meaning;
  json_object_foreach((json_t *)values, value, meaning) {
    buffer line = {""};
    add(&line, "`\"%s\"`: %s", value, json_string_value(meaning));
    wrap("  - ", "    ", line.text);
  }
}

static void path_of(char *out, size_t size, const char *path, const char *key, const json_t *node) {
  const json_t *resolved = resolve(node);
  const char *type = string(resolved, "type");
  snprintf(out, size, "%s%s%s%s", path, path[0] ? "." : "", key, type && strcmp(type, "array") == 0 ? "[]" : "");
}

/* The keys of an object, and then the parts of the objects under it. */
static void write_keys(const json_t *object, const char *path, int depth) {
  const json_t *properties = json_object_get(object, "properties");
  char below[256];
  const char *key;
  json_t *node;
  json_object_foreach((json_t *)properties, key, node) {
    if (strcmp(key, "if") == 0)
      continue; /* said once, at the head */
    path_of(below, sizeof below, path, key, node);
    write_key(object, below, key, node);
  }
  json_object_foreach((json_t *)properties, key, node) {
    const json_t *inner = object_of(node);
    if (!inner)
      continue;
    path_of(below, sizeof below, path, key, node);
    fprintf(page, "\n%.*s `%s`\n\n", depth, "######", below);
    write_keys(inner, below, depth < 4 ? depth + 1 : 4);
  }
}

static void write_shared(const char *name, const json_t *definition) {
  fprintf(page, "\n### %s\n\n", name);
  wrap("", "", text_of(definition));
  size_t i;
  json_t *choice;
  if (json_object_get(definition, "properties")) {
    fputc('\n', page);
    write_keys(definition, name, 4);
  }
  json_array_foreach(json_object_get(definition, "oneOf"), i, choice) {
    if (json_object_get(choice, "properties")) {
      fputs("\nAs an object:\n\n", page);
      write_keys(choice, name, 4);
    }
  }
}

static void write_page(void) {
  fputs("# The scene\n\n", page);
  wrap("", "",
       "Made from [scenes' schema](../scenarios/scene.schema.json) by the target `scene_reference`; edit the texts "
       "there, not here.");
  fputc('\n', page);
  wrap("", "", string(schema, "description"));
  fputc('\n', page);
  wrap("", "",
       "A list of objects is named with brackets: `dem.bodies[]` is an entry of `dem.bodies`. Behind a key stand its "
       "unit ([1]: none), what it may be, and its default; keys with neither a default nor **required** may be left "
       "out, or their text says when they are needed. In a list each object may have the key `if`: where it is 0 or "
       "false the object is left out ([expressions](runs.md#parameters)).");
  fputs("\n## Sections\n\n", page);
  write_keys(schema, "", 3);
  fputs("\n## Shared forms\n", page);
  const char *name;
  json_t *definition;
  json_object_foreach(json_object_get(schema, "definitions"), name, definition) {
    if (is_shared(name))
      write_shared(name, definition);
  }
}

/* ---- the file ---- */

static char *contents(const char *path) {
  FILE *f = fopen(path, "rb");
  if (!f)
    return NULL;
  size_t n = 0, room = 1 << 20;
  char *text = malloc(room);
  if (text)
    n = fread(text, 1, room - 1, f);
  if (text)
    text[n] = '\0';
  fclose(f);
  return text;
}

int main(int argc, char **argv) {
  bool check = argc > 1 && strcmp(argv[1], "--check") == 0;
  if (argc != 3 + check) {
    fputs("usage: write_scene_reference [--check] SCHEMA PAGE\n", stderr);
    return 2;
  }
  json_error_t error;
  json_t *root = json_load_file(argv[1 + check], 0, &error);
  if (!root) {
    fprintf(stderr, "write_scene_reference: %s:%d: %s\n", argv[1 + check], error.line, error.text);
    return EXIT_FAILURE;
  }
  schema = root;
  char *made = NULL;
  size_t size = 0;
  page = open_memstream(&made, &size);
  if (!page)
    return EXIT_FAILURE;
  write_page();
  fclose(page);
  const char *file = argv[2 + check];
  int status = EXIT_SUCCESS;
  if (check) {
    char *there = contents(file);
    if (!there || strcmp(there, made) != 0) {
      fprintf(stderr, "%s is not what the schema gives: build the target scene_reference\n", file);
      status = EXIT_FAILURE;
    }
    free(there);
  } else {
    FILE *out = fopen(file, "wb");
    if (!out || fwrite(made, 1, size, out) != size || fclose(out)) {
      fprintf(stderr, "write_scene_reference: cannot write %s\n", file);
      status = EXIT_FAILURE;
    }
  }
  free(made);
  json_decref(root);
  return status;
}
