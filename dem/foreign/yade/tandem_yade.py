#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""tandem-yade: Yade in the place of tandem-dem. README.md tells what a script is to have, yade_script.py reads it,
yade_bodies.py moves what is coupled, yade_windows.py is what Yade's loop calls."""
import os
import sys
import traceback

# this program and what it needs lie as in an installation, also in the build tree
PREFIX = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(PREFIX, "share", "tandem", "python"))


def take_threads(words):
    """--threads N, the option that is not the server's: N, and the other words."""
    if "--threads" not in words:
        return 1, words
    at = words.index("--threads")
    number = words[at + 1] if at + 1 < len(words) else ""
    if not number.isdigit() or not 1 <= int(number) <= 1024:
        sys.exit("--threads %s: give a whole number from 1 to 1024" % number)
    return int(number), words[:at] + words[at + 2:]


def run():
    """Yade is loaded before the server is spoken to: that takes seconds, in which nothing could tell that it lives."""
    from tandem_participant import Participant
    import yade_script
    threads, words = take_threads(sys.argv[1:])
    failure = yade_script.boot(threads) if words else None
    with Participant.from_arguments("dem", "tandem-yade", ["interface"], words) as participant:
        if failure:
            raise failure
        from yade_windows import Windows
        assignment = participant.initialize()
        script = yade_script.Script(yade_script.Section(assignment.scene), assignment, participant)
        Windows(participant, assignment, script).run()


def main():
    """Yade's own threads and libraries do not always survive the interpreter's end, so that is not waited for."""
    status = 0
    try:
        run()
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else 1
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
    except BaseException:
        traceback.print_exc()
        status = 1
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


main()
