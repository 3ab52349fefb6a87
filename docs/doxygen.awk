# Marks the comments of a public header for Doxygen, which are plain C: those of the file, those before a declaration and
# those behind one. Declarations that follow each other without a blank line share the comment of the first, and fields
# of one line the comment behind them.
# SPDX-License-Identifier: GPL-3.0-or-later

!/^#/ { gsub(/<[a-z]+>/, "\\\\&") } # <role> is no HTML

# a comment at file scope: remember it
/^\/\* / && !/SPDX-/ && !/^\/\* -/ {
  sub(/^\/\* /, FNR == 1 ? "/** \\file\n * " : "/** ")
  comment = ""
  open = 1
}
open {
  comment = comment $0 "\n"
  if (/\*\//)
    open = 0
  print
  next
}

# "double first, last; // when" as one field after the other, still on one line
/^ +[a-z][^()]*, [^()]*;/ {
  end = index($0, ";")
  fields = split(substr($0, 1, end - 1), field, /, /)
  behind_them = substr($0, end + 1)
  if (match(behind_them, /^ +\/\* /))
    behind_them = " /**< " substr(behind_them, RLENGTH + 1) " "
  type = field[1]
  sub(/ [*]*[A-Za-z0-9_]+(\[[^\]]*\])*$/, " ", type)
  line = field[1] ";"
  for (k = 2; k <= fields; k++)
    line = line (behind_them ~ /\*\// ? behind_them : behind_them ? " /**< with the next */ " : "") type field[k] ";"
  $0 = line behind_them
}

/^$/ { comment = "" }
/^[a-z]/ && behind { printf "%s", comment } # the next of several declarations
{
  behind = /^[a-z].*;/ || (behind_lines && /;$/)
  behind_lines = /^[a-z]/ && !/;/ && !/\{/
  if (match($0, /^ +\/\* /))
    $0 = "  /** " substr($0, RLENGTH + 1)
  else if (match($0, /[;,] +\/\* /))
    $0 = substr($0, 1, RSTART) " /**< " substr($0, RSTART + RLENGTH)
  print
}
