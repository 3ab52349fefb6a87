# Marks the comments of a public header for Doxygen, which are plain C: those of the file, those before a declaration and
# those behind one. Declarations that follow each other without a blank line share the comment of the first.
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
