//! `--executor`: what ends the program ends the interpreter that it has started.
#![cfg(unix)]

use crate::common::Studies;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Stdio};

/// In place of Python: runs until its input ends.
const INTERPRETER: &str = "#!/bin/sh
case \"$2\" in *command*) ;; *) exit 0 ;; esac
echo \"safe path $PYTHONSAFEPATH\" >&2
cat
echo ended >&2
exit 1
";

#[test]
fn a_signal_to_the_program_alone_ends_the_interpreter_too() {
    let studies = Studies::new();
    let interpreter = studies.file("python", INTERPRETER);
    std::fs::set_permissions(&interpreter, std::fs::Permissions::from_mode(0o755)).unwrap();
    for (signal, code) in
        [("-INT", Some(1)), ("-TERM", Some(1)), ("-HUP", Some(1)), ("-KILL", None)]
    {
        let mut program = studies.command("study", 4, &["--executor", "processes"]);
        program.env("FINGER_OPT_PYTHON", &interpreter).stderr(Stdio::piped());
        let mut program = program.spawn().unwrap();
        let mut said = BufReader::new(program.stderr.take().unwrap()).lines().map(Result::unwrap);
        assert_eq!(said.next().unwrap(), "safe path 1");
        let kill = Command::new("kill").args([signal, &program.id().to_string()]).status();
        assert!(kill.unwrap().success());
        assert_eq!(said.next().unwrap(), "ended", "{signal}");
        assert_eq!(program.wait().unwrap().code(), code, "{signal}");
    }
}
