from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(
    **generate_distutils_setup(
        packages=["vibro_impact", "vibro_impact.report"],
        package_dir={"": "python"},
        package_data={"vibro_impact.report": ["page.*", "assets/*"]},
    )
)
