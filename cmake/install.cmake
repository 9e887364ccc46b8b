# What an install holds besides libraries and programs, which are installed where they are built.

install(DIRECTORY include/${PROJECT_NAME}/ DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION} FILES_MATCHING PATTERN "*.h")
install(FILES nodelets.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
install(DIRECTORY config launch rviz DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})

# The scripts for use; those that build and test the repository stay in it.
catkin_install_python(
  PROGRAMS scripts/landmarks scripts/limiting_case scripts/live scripts/plot_frf scripts/plot_simulation scripts/replay_contact
    scripts/report
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(PROGRAMS scripts/isolated DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(FILES scripts/frequency_response.py scripts/live_feed.py scripts/live_frame.py DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
