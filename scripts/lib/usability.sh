# shellcheck shell=bash
# Whether a user of a setup file finds everything the package offers, and it runs. Needs common.sh.

# check_usability SETUP_FILE: prints what it does; fails at the first thing that does not work.
check_usability()
{
  : "${root:?source common.sh first}"
  local setup="$1" message launch_file program master
  clean_ros_environment
  source_setup "${setup}"
  cd "${TMPDIR:-/tmp}" || return

  for message in "${root}"/msg/*.msg; do
    message="vibro_impact/$(basename "${message}" .msg)"
    echo "rosmsg show ${message}"
    rosmsg show "${message}"
  done
  echo "import of the messages from Python"
  /usr/bin/python3 -c 'import vibro_impact.msg; vibro_impact.msg.Impact()'
  echo "import of the package from Python"
  /usr/bin/python3 -c 'import vibro_impact; vibro_impact.read_bag'

  for launch_file in "${root}"/launch/*.launch; do
    launch_file="$(basename "${launch_file}")"
    echo "roslaunch --ros-args vibro_impact ${launch_file}"
    roslaunch --ros-args vibro_impact "${launch_file}"
  done
  for program in converge extract_frf frf_sweep isolated landmarks limiting_case live plot_frf plot_simulation replay_check replay_contact report simulate write_signal; do
    echo "rosrun vibro_impact ${program} --help"
    rosrun vibro_impact "${program}" --help
  done

  # A master of its own, which roslaunch starts and ends; within five minutes, whatever happens.
  ROS_MASTER_URI="http://localhost:$(free_port)"
  export ROS_MASTER_URI
  echo "roslaunch vibro_impact simulator.launch; rostopic echo /model_info; rosrun vibro_impact shaker"
  timeout --kill-after=30 300 roslaunch vibro_impact simulator.launch &
  master=$!
  # SIGTERM: processes that a script starts in the background ignore SIGINT.
  # shellcheck disable=SC2064
  trap "kill -TERM ${master} 2>/dev/null; wait ${master}" EXIT
  for _ in $(seq 60); do
    rosparam get /run_id >/dev/null 2>&1 && break
    sleep 1
  done
  timeout 60 rostopic echo -n 1 /model_info
  for program in monitor shaker simulator; do
    rosrun --prefix 'test -x' vibro_impact "${program}"
  done
}
