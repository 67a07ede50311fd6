"""python -m geomtorsion: the command line without its script."""

from geomtorsion.cli import main

if __name__ == "__main__":
    main()
