# SPDX-License-Identifier: GPL-3.0-or-later
"""Table of all known keywords of CalculiX and Abaqus. Every parameter is used, without influence, or unsupported."""
from __future__ import annotations

from statejump.kinds.truss.importing.contract import Card, idle, refused, table, used

TURNS = "inertia of rotations does not act in statics"
TIME = "it changes with time or with another run"
TABLE = "properties that depend on fields"
OUTPUT = "output"
SOLVE = "how a program solves"
DYNAMIC = "acts in dynamics, buckling or modes only; the import takes structure, static loads and temperatures"
HEAT = "heat transfer: temperatures are those of *TEMPERATURE"
CONTACT = "contact"
TIES = "couplings of surfaces, and equations of other kinds"
BODY = "rigid body or equations, as RBE2 of Nastran"
USER = "a routine of the user"
# In this table "_" stands for a blank in a name, because blanks separate names.
KEYWORDS: dict[str, Card] = table(
    used("NODE", "node", "NSET SYSTEM INPUT", refused={"INPUT": "a file of its own"}),
    used("SYSTEM", "coordinate system of nodes"),
    used("NGEN", "nodes in a line or an arc", "NSET LINE SYSTEM", refused={"SYSTEM": "coordinates of the extra point"}),
    used("NFILL", "nodes between two sets", "NSET BIAS TWO STEP SINGULAR",
         refused={"BIAS TWO STEP SINGULAR": "uneven distances"}),
    used("NCOPY", "copied nodes", "CHANGE_NUMBER OLD_SET NEW_SET SHIFT MULTIPLE REFLECT POLE", refused={"REFLECT "
         "POLE": "copies that are mirrored or projected"}),
    used("ELGEN", "links in rows", "ELSET ALLNODES", refused={"ALLNODES": "nodes with numbers of their own"}),
    used("ELCOPY", "copied links", "ELEMENT_SHIFT OLD_SET NEW_SET SHIFT_NODES REFLECT",
         refused={"REFLECT": "copies that are mirrored"}),
    used("ELEMENT", "link, beam, spring or mass by its TYPE", "TYPE ELSET INPUT",
         refused={"INPUT": "a file of its own"}),
    used("NSET", "names", "NSET GENERATE ELSET INSTANCE UNSORTED INTERNAL", idle={"UNSORTED INTERNAL": "names only"}),
    used("ELSET", "names", "ELSET GENERATE INSTANCE UNSORTED INTERNAL", idle={"UNSORTED INTERNAL": "names only"}),
    used("PARAMETER", "numbers for names in angle brackets; expressions are refused"),
    used("PART", "nodes and links of every instance", "NAME"),
    used("END_PART", "end of a part"), used("END_INSTANCE", "end of an instance"),
    used("END_ASSEMBLY", "end of the assembly"), used("ASSEMBLY", "names", "NAME"),
    used("INSTANCE", "a part, shifted and rotated", "NAME PART LIBRARY", refused={"LIBRARY": "a part of another file"}),
    used("TRANSFORM", "directions of supports and forces", "NSET TYPE"),
    used("MATERIAL", "material", "NAME RTOL", idle={"RTOL": SOLVE}),
    used("ELASTIC", "Young's modulus and Poisson's ratio", "TYPE DEPENDENCIES MODULI",
         idle={"MODULI": "of viscoelastic materials"}, refused={"DEPENDENCIES": TABLE}),
    used("EXPANSION", "thermal expansion", "TYPE ZERO DEPENDENCIES USER PORE_FLUID",
         refused={"DEPENDENCIES": TABLE, "USER": USER, "PORE_FLUID": "porous media"}),
    used("DENSITY", "density", "DEPENDENCIES", refused={"DEPENDENCIES": TABLE}),
    used("SOLID_SECTION", "area", "ELSET MATERIAL ORIENTATION CONTROLS NODAL_THICKNESS COMPOSITE REF_NODE",
         idle={"ORIENTATION": "the material is isotropic", "CONTROLS REF_NODE": SOLVE},
         refused={"NODAL_THICKNESS": "areas of nodes", "COMPOSITE": "layers"}),
    used("BEAM_SECTION", "section and direction n1; RECT, CIRC, PIPE, BOX and I whose centroid is at their nodes, "
         "without OFFSET1 and OFFSET2; with `--beams-as-bars` the area, also of L and TRAPEZOID",
         "ELSET MATERIAL SECTION OFFSET1 OFFSET2 POISSON TEMPERATURE ROTARY_INERTIA LUMPED ORIENTATION "
         "NODAL_THICKNESS",
         idle={"POISSON": "strains across the beam", "ROTARY_INERTIA": TURNS,
               "ORIENTATION": "the material is isotropic", "TEMPERATURE LUMPED": SOLVE}),
    used("NODAL_THICKNESS", "sizes of RECT and CIRC at two nodes; the beam is divided into 8 uniform ones"),
    used("BEAM_GENERAL_SECTION", "section and material of SECTION=GENERAL", "ELSET SECTION DENSITY POISSON ZERO",
         idle={"POISSON": "strains across the beam"}),
    used("NORMAL", "direction n2 of beams at their nodes, one for each beam"),
    used("TRANSVERSE_SHEAR_STIFFNESS", "nothing without beams; else it is refused"),
    used("SPRING", "spring along its line or to the ground", "ELSET NONLINEAR ORIENTATION DEPENDENCIES "
         "COMPLEX_STIFFNESS RTOL", idle={"RTOL": SOLVE, "COMPLEX_STIFFNESS": DYNAMIC},
         refused={"NONLINEAR": "a spring that is not linear", "ORIENTATION": "directions of its own",
                  "DEPENDENCIES": TABLE}),
    used("MASS", "mass of nodes", "ELSET ALPHA COMPOSITE TYPE", idle={"ALPHA COMPOSITE": DYNAMIC},
         refused={"TYPE": "a mass of one direction"}),
    used("EQUATION", "support, one node of two at one place, loads of a node at which no bar ends, or constraint; "
         "directions 4 to 6 where beams end",
         "INPUT REMOVE", refused={"INPUT": "a file of its own", "REMOVE": TIME}),
    used("BOUNDARY", "directions without motion", "OP AMPLITUDE FIXED USER SUBMODEL STEP DATASET LOAD_CASE MASS_FLOW "
         "TYPE REGION_TYPE",
         idle={"AMPLITUDE TYPE": "of motions that are not 0, which are not supported", "REGION_TYPE LOAD_CASE": SOLVE},
         refused={"FIXED SUBMODEL STEP DATASET": TIME, "USER": USER, "MASS_FLOW": "a fluid"}),
    used("CLOAD", "force; moment, where beams end; with `--beams-as-bars` a moment that bends a beam is refused",
         "OP AMPLITUDE SUBMODEL STEP DATASET TIME_DELAY USER SECTOR LOAD_CASE OMEGA0 FOLLOWER REGION_TYPE CYCLIC_MODE",
         idle={"REGION_TYPE CYCLIC_MODE": SOLVE},
         refused={"SUBMODEL STEP DATASET TIME_DELAY": TIME, "USER": USER, "FOLLOWER": "a load that turns",
                  "SECTOR LOAD_CASE OMEGA0": "loads of cyclic symmetry"}),
    used("DLOAD", "gravity; P1 and P2 on beams with SECTION=RECT: forces and moments of both ends",
         "OP AMPLITUDE TIME_DELAY LOAD_CASE SECTOR SUBMODEL REGION_TYPE",
         idle={"REGION_TYPE": SOLVE},
         refused={"TIME_DELAY SUBMODEL": TIME, "LOAD_CASE SECTOR": "loads of cyclic symmetry"}),
    used("TEMPERATURE", "temperature of links", "OP AMPLITUDE TIME_DELAY USER SUBMODEL STEP DATASET FILE BSTEP BINC "
         "ESTEP EINC INTERPOLATE",
         refused={"TIME_DELAY SUBMODEL STEP DATASET FILE BSTEP BINC ESTEP EINC INTERPOLATE": TIME, "USER": USER}),
    used("INITIAL_CONDITIONS", "TYPE=TEMPERATURE: temperature free of stress", "TYPE USER FILE STEP INC",
         refused={"USER": USER, "FILE STEP INC": TIME}),
    used("AMPLITUDE", "factor of loads at the end of a static step", "NAME TIME VALUE DEFINITION SMOOTH INPUT SHIFTX "
         "SHIFTY FACTOR USER", idle={"SMOOTH": DYNAMIC},
         refused={"INPUT USER": USER, "SHIFTX SHIFTY FACTOR": "shifts"}),
    used("STEP", "the first one, or that of --step", "NLGEOM NAME INC INCF PERTURBATION AMPLITUDE DIRECT "
         "THERMAL_NETWORK UNSYMM EXTRAPOLATION SHELL_OFFSET CONVERT_SDI SOLVER STABILIZE TURBULENCE_MODEL "
         "INCREMENTATION",
         idle={"NLGEOM": "the solver always is geometrically exact", "NAME INC INCF AMPLITUDE DIRECT THERMAL_NETWORK "
               "UNSYMM EXTRAPOLATION SHELL_OFFSET CONVERT_SDI SOLVER STABILIZE TURBULENCE_MODEL INCREMENTATION": SOLVE,
               "PERTURBATION": "of a first step; behind others it is not supported"}),
    used("STATIC", "its period, for *AMPLITUDE", "DIRECT SOLVER STABILIZE TIME_RESET TOTAL_TIME_AT_START EXPLICIT "
         "CONTINUE ALLSDTOL FACTOR RIKS", idle={"DIRECT SOLVER STABILIZE TIME_RESET TOTAL_TIME_AT_START EXPLICIT "
                                                "CONTINUE ALLSDTOL FACTOR RIKS": SOLVE}),
    used("END_STEP", "end of a step"),
    used("RIGID_BODY", f"{BODY}; NSET and PIN_NSET by displacements, TIE_NSET also by rotations",
         "NSET REF_NODE ROT_NODE PIN_NSET TIE_NSET ELSET POSITION ANALYTICAL_SURFACE ISOTHERMAL",
         idle={"ISOTHERMAL": HEAT}, refused={"ELSET ANALYTICAL_SURFACE": "a body of elements or surfaces",
                                             "POSITION": "a node that moves to the centre of the body"}),
    used("KINEMATIC_COUPLING", BODY, "REF_NODE ORIENTATION", refused={"ORIENTATION": "directions of its own"}),
    used("SURFACE", "TYPE=NODE: nodes of *COUPLING", "NAME TYPE COMBINE CROP FILL_ENDS INTERNAL MAX_RATIO NO_OFFSET "
         "NO_THICK DEFINITION SCALE_THICK REGION_TYPE OFFSET TRIM PROPERTY",
         idle={"COMBINE CROP FILL_ENDS INTERNAL MAX_RATIO NO_OFFSET NO_THICK DEFINITION SCALE_THICK REGION_TYPE OFFSET "
               "TRIM PROPERTY": "of surfaces of elements"}),
    used("COUPLING", BODY, "REF_NODE SURFACE CONSTRAINT_NAME ORIENTATION INFLUENCE_RADIUS ALPHA",
         idle={"CONSTRAINT_NAME": "a name"},
         refused={"ORIENTATION": "directions of its own", "INFLUENCE_RADIUS": "a part of its surface",
                  "ALPHA": "thermal expansion of a rigid body"}),
    used("KINEMATIC", "components of *COUPLING"),
    used("DISTRIBUTING", "`[[mean]]` of *COUPLING; weights are the areas of its surface of nodes, or 1",
         "COUPLING WEIGHTING_METHOD CYCLIC_SYMMETRY", refused={"CYCLIC_SYMMETRY": "cyclic symmetry"}),
    used("DISTRIBUTING_COUPLING", "`[[mean]]` with the node of an element DCOUP2D or DCOUP3D at the centre of "
         "the nodes", "ELSET"),
    # Not supported.
    refused("MPC TIE "
            "EMBEDDED_ELEMENT MULTI_POINT_CONSTRAINTS NETWORK_MPC SHELL_TO_SOLID_COUPLING", TIES),
    refused("SURFACE_INTERACTION SURFACE_BEHAVIOR CONTACT_PAIR CONTACT FRICTION CLEARANCE GAP CONTACT_DAMPING "
            "CONTACT_CONTROLS CHANGE_CONTACT_TYPE MODEL_CHANGE", CONTACT),
    refused("PRE-TENSION_SECTION RELEASE PRETENSION_SECTION", "cuts and pre-tension of elements"),
    refused("SHELL_SECTION SHELL_GENERAL_SECTION MEMBRANE_SECTION FLUID_SECTION COHESIVE_SECTION CONNECTOR_SECTION "
            "RIGID_SURFACE SUBSTRUCTURE_PROPERTY MATRIX_ASSEMBLE USER_ELEMENT USER_SECTION FRAME_SECTION "
            "CONNECTOR_BEHAVIOR CONNECTOR_ELASTICITY JOINT", "elements that are no straight bars"),
    refused("ORIENTATION DISTRIBUTION", "directions of elements"),
    refused("PLASTIC CYCLIC_HARDENING CREEP HYPERELASTIC HYPERFOAM DEFORMATION_PLASTICITY USER_MATERIAL VISCOELASTIC "
            "VISCO NO_COMPRESSION MOHR_COULOMB DRUCKER_PRAGER CONCRETE RATE_DEPENDENT ANNEAL_TEMPERATURE FAIL_STRAIN "
            "NO_TENSION", "material that is not linear"),
    refused("INERTIA_RELIEF CENTRIF BASE_MOTION FIELD IMPERFECTION ELEMENT_MATRIX MASS_ADJUST NONSTRUCTURAL_MASS "
            "CYCLIC_SYMMETRY_MODEL SUBMODEL SUBSTRUCTURE_GENERATE RESTART_READ MAP_SOLUTION DSLOAD", "the structure "
            "or its loads are those of something else"),
    # No influence.
    idle("NO_ANALYSIS HEADING PREPRINT ECHO NODE_PRINT EL_PRINT NODE_FILE EL_FILE NODE_OUTPUT ELEMENT_OUTPUT "
         "ELEMENT_FILE OUTPUT RESTART CONTACT_FILE CONTACT_PRINT CONTACT_OUTPUT ENERGY_OUTPUT ENERGY_PRINT "
         "ENERGY_FILE MODAL_OUTPUT MODAL_FILE MODAL_PRINT SECTION_PRINT SECTION_FILE FACE_PRINT MONITOR FILE_FORMAT "
         "PRINT DIAGNOSTICS INTEGRATED_OUTPUT INTEGRATED_OUTPUT_SECTION TIME_POINTS TIMEPOINTS RADIATION_FILE COMMENT "
         "END", OUTPUT),
    idle("CONTROLS SOLVER_CONTROLS SECTION_CONTROLS FILTER PHYSICAL_CONSTANTS VALUES_AT_INFINITY "
         "ANALYSIS DYNAMIC_CONTROLS DASHPOT DAMPING ROTARY_INERTIA BEAM_ADDED_INERTIA",
         "inertia of rotations, damping, or how a program solves"),
    idle("DYNAMIC FREQUENCY BUCKLE MODAL_DYNAMIC STEADY_STATE_DYNAMICS COMPLEX_FREQUENCY MODAL_DAMPING GLOBAL_DAMPING "
         "SELECT_CYCLIC_SYMMETRY_MODES SELECT_EIGENMODES RANDOM_RESPONSE RESPONSE_SPECTRUM GREEN GEOSTATIC "
         "SENSITIVITY DESIGN_VARIABLES OBJECTIVE CONSTRAINT COUPLED_TEMPERATURE-DISPLACEMENT "
         "UNCOUPLED_TEMPERATURE-DISPLACEMENT CORRELATION_LENGTH ROBUST_DESIGN CRACK_PROPAGATION", DYNAMIC),
    idle("HEAT_TRANSFER CONDUCTIVITY SPECIFIC_HEAT CFLUX DFLUX FILM RADIATE LATENT_HEAT HEAT_GENERATION "
         "CAVITY_RADIATION EMISSIVITY GAP_CONDUCTANCE GAP_HEAT_GENERATION FLUID_CONSTANTS SPECIFIC_GAS_CONSTANT", HEAT),
    idle("ELECTRICAL_CONDUCTIVITY MAGNETIC_PERMEABILITY ELECTROMAGNETICS", "electromagnetics"),
    idle("DEPVAR", "state of routines that are not supported"),
)

# Families of elements; "nothing" has no influence.
BAR, BEAM, SPRING, MASS, COUPLING, NOTHING = "bar", "beam", "spring", "mass", "coupling", "nothing"
ELEMENTS: dict[str, tuple[str, int]] = {
    "T2D2": (BAR, 2), "T3D2": (BAR, 2), "T2D3": (BAR, 3), "T3D3": (BAR, 3), "T2D2T": (BAR, 2), "T3D2T": (BAR, 2),
    **{name: (BEAM, 2) for name in ("B21", "B21H", "B23", "B31", "B31R", "B31H", "B31OS", "B33", "PIPE21", "PIPE31")},
    **{name: (BEAM, 3) for name in ("B22", "B32", "B32R", "B32H", "B32OS", "PIPE22", "PIPE32")},
    "SPRINGA": (SPRING, 2), "SPRING1": (SPRING, 1), "SPRING2": (SPRING, 2), "MASS": (MASS, 1),
    "DCOUP2D": (COUPLING, 1), "DCOUP3D": (COUPLING, 1),
    "ROTARYI": (NOTHING, 1), "DASHPOTA": (NOTHING, 2), "DASHPOT1": (NOTHING, 1), "DASHPOT2": (NOTHING, 2),
}
