# Which way includes may go: no circles of units (a .c and a .h of one name), and a room (a folder) includes only rooms
# below it. A room of dem/ is small enough to be read at a sitting. Run: cmake -DROOT=<source directory> -P arrows.cmake
# SPDX-License-Identifier: GPL-3.0-or-later
cmake_minimum_required(VERSION 3.16)

# The rooms of each part, a floor a line, from the bottom up: a room may include those of lower floors and all of
# protocol/. A file that lies in the part's own folder is a room by itself.
set(protocol
  "base"
  "math"
  "scene view"
  "motion parameters results surface wire"
  "app fmi"
  "record"
  "draw"
  "draw/space"
  "draw/program"
  "output")
set(dem
  "base foreign/liggghts"
  "numbers geometry search/method"
  "geometry/mesh geometry/wall"
  "geometry/shape model"
  "state contact/law geometry/screen moldyn"
  "seam"
  "contact/tangential contact/rolling contact/twisting contact/cohesion particles bodies exchange"
  "contact search proxy flow dem.h"
  "contact/loop scene store watch"
  "contact/normal step channels"
  "settle contact/multi output"
  "adapter"
  "app"
  "main.c ranks")
set(mbd
  "adams linear shape"
  "model"
  "joint"
  "driver force"
  "mechanics"
  "equations"
  "consistent"
  "assembly integrate mbd.h foreign/fmu"
  "integrate/alpha reduced"
  "scene"
  "engine"
  "adapter"
  "app"
  "main.c")
set(coupler
  "settings page choice export/guest"
  "session"
  "state"
  "loop estimate"
  "observe scheme"
  "run live results"
  "cells contents trial conform export/serve"
  "advise study export conform/rules"
  "calibrate verify"
  "report"
  "sweep"
  "help.h"
  "main.c")
# the program that starts all of them
set(knows_all coupler/main.c)

# Files in a room, but for those that hold a family: a file a contact law, joint, scheme ...
set(least 4)
set(most 10)
set(families
  dem/contact/normal dem/contact/tangential dem/contact/rolling dem/contact/twisting dem/contact/cohesion
  dem/contact/multi
  mbd/joint mbd/force mbd/driver coupler/scheme coupler/observe coupler/conform/rules protocol/motion)
# two files that are a floor of their own: a participant, a command
set(other_sizes mbd/adapter mbd/app)

set(bad "")
foreach(part protocol dem mbd coupler)
  set(floor 0)
  foreach(rooms IN LISTS ${part})
    math(EXPR floor "${floor} + 1")
    separate_arguments(rooms)
    foreach(room IN LISTS rooms)
      set(floor_${part}/${room} ${floor})
    endforeach()
  endforeach()
endforeach()

# the part of a file and its room: its folder, or the file itself if that is the part's
function(room_of file part room)
  string(REGEX REPLACE "/.*$" "" top "${file}")
  string(REGEX REPLACE "/[^/]*$" "" folder "${file}")
  if(folder STREQUAL top)
    set(folder "${file}")
  endif()
  set(${part} "${top}" PARENT_SCOPE)
  set(${room} "${folder}" PARENT_SCOPE)
endfunction()

set(units "")
set(rooms "")
file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/dem/*.[ch] ${ROOT}/mbd/*.[ch] ${ROOT}/coupler/*.[ch]
     ${ROOT}/protocol/*.[ch])
list(LENGTH files count)
if(count LESS 100)
  message(FATAL_ERROR "${ROOT} has ${count} source files; give the source directory as ROOT")
endif()
foreach(file IN LISTS files)
  string(REGEX REPLACE "\\.[ch]$" "" unit "${file}")
  list(APPEND units "${unit}")
  room_of("${file}" part room)
  list(APPEND rooms "${room}")
  list(APPEND in_${room} "${file}")
  if(NOT DEFINED floor_${room})
    list(APPEND bad "${file}: give ${room} a floor in arrows.cmake")
    continue()
  endif()
  file(STRINGS ${ROOT}/${file} lines REGEX "^#include \"[^\"]+\"")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^#include \"([^\"]+)\".*$" "\\1" other "${line}")
    if(NOT other IN_LIST files)
      continue() # made by the build, or a system header
    endif()
    string(REGEX REPLACE "\\.[ch]$" "" other_unit "${other}")
    if(NOT other_unit STREQUAL unit)
      list(APPEND needs_${unit} "${other_unit}")
    endif()
    room_of("${other}" other_part other_room)
    if(other_room STREQUAL room OR file IN_LIST knows_all)
      continue()
    elseif(other_part STREQUAL part)
      if(NOT DEFINED floor_${other_room} OR NOT floor_${other_room} LESS floor_${room})
        list(APPEND bad "${file} includes ${other}: ${other_room} is not below ${room}")
      endif()
    elseif(NOT other_part STREQUAL "protocol")
      list(APPEND bad "${file} includes ${other}: ${part} may not know ${other_part}")
    endif()
  endforeach()
endforeach()
list(REMOVE_DUPLICATES units)

list(REMOVE_DUPLICATES rooms)
foreach(room IN LISTS rooms)
  list(LENGTH in_${room} count)
  if(NOT room MATCHES "\\.[ch]$" AND NOT room IN_LIST families AND NOT room IN_LIST other_sizes
     AND (count LESS least OR count GREATER most))
    list(APPEND bad "${room} has ${count} files; a room has ${least} to ${most}")
  endif()
endforeach()

# take units away that need no other, until those are left that are in a circle or need one
set(more TRUE)
while(more)
  set(more FALSE)
  set(left "")
  foreach(unit IN LISTS units)
    set(needs "")
    foreach(other IN LISTS needs_${unit})
      if(other IN_LIST units)
        list(APPEND needs "${other}")
      endif()
    endforeach()
    list(REMOVE_DUPLICATES needs)
    set(needs_${unit} ${needs})
    if(needs)
      list(APPEND left "${unit}")
    else()
      set(more TRUE)
    endif()
  endforeach()
  set(units ${left})
endwhile()

# likewise those that no other needs
set(more TRUE)
while(more)
  set(more FALSE)
  set(needed "")
  foreach(unit IN LISTS units)
    list(APPEND needed ${needs_${unit}})
  endforeach()
  foreach(unit IN LISTS units)
    if(NOT unit IN_LIST needed)
      list(REMOVE_ITEM units "${unit}")
      set(more TRUE)
    endif()
  endforeach()
endwhile()
foreach(unit IN LISTS units)
  list(APPEND bad "in a circle: ${unit} includes ${needs_${unit}}")
endforeach()

foreach(what IN LISTS bad)
  message(SEND_ERROR "${what}")
endforeach()
