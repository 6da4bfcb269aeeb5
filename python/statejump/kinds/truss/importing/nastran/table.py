# SPDX-License-Identifier: GPL-3.0-or-later
"""Table of all known bulk data cards and case control commands. Each is used, without influence, or unsupported."""
from __future__ import annotations

from statejump.kinds.truss.importing.contract import Card, idle, refused, table, used

TURNS = "nodes of a truss do not rotate"
WARPING = "warping: torsion is that of St. Venant"
AS_BARS = "; with `--beams-as-bars` a pin-jointed bar, whose offsets must be equal at both ends or along the bar"
MATERIAL_DAMPING = "damping does not act in statics"
SECTION_POINTS = "points where stress is printed"
DYNAMIC = "acts in dynamics, buckling or modes only; the import takes structure, static loads and temperatures"
DESIGN = "optimization: the first design is taken"
AERO = "aerodynamics: acts through TRIM, which is not supported, or in flutter and gusts"
HEAT = "heat transfer: temperatures are those of TEMP and TEMPD"
OUTPUT = "output"
THROUGH = "acts through elements that name it, which are not supported"
SHELL, SOLID = "shells are no part of a truss", "solids are no part of a truss"
RIGID = "rigid element of another kind"
SUPORTED = "supports of inertia relief or of a rigid body; in modes and responses they hold nothing and are left out"
EXACT = "reduction, exact in statics"
BODY = ("one node of those at one position, where forces and masses of the others act; `[[rigid]]` if bars end at "
        "several positions; free rotations become hinges; some displacements beside free rotations are refused")
EXPANDS = "thermal expansion of a rigid bar"
TWIST = "moment, where beams end; nothing where it twists rods; with `--beams-as-bars` refused if it bends beams"
CELAS = "spring along its line or to the ground; of rotations where supports hold its node across its axis"
POINTS = "end A: C1 C2 D1 D2 E1 E2 F1 F2"

CARDS: dict[str, Card] = table(
    used("GRID", "node", "ID CP X1 X2 X3 CD PS SEID", idle={"SEID": "superelement: the structure is taken as one"}),
    used("GRDSET", "defaults of GRID", "- CP - - - CD PS SEID",
         idle={"SEID": "superelement: the structure is taken as one"}),
    *(used(f"CORD1{kind}", "coordinate system", "CIDA G1A G2A G3A CIDB G1B G2B G3B") for kind in "RCS"),
    *(used(f"CORD2{kind}", "coordinate system", "CID RID A1 A2 A3 B1 B2 B3 C1 C2 C3") for kind in "RCS"),
    # Elements and their sections.
    used("CROD", "link, two on a card of COSMIC", "EID PID G1 G2 EID2 PID2 G3 G4"),
    used("CTUBE", "link, two on a card of COSMIC", "EID PID G1 G2 EID2 PID2 G3 G4"),
    used("CONROD", "link; beam with torsion only, between ends of beams", "EID G1 G2 MID A J C NSM",
         idle={"C": SECTION_POINTS}),
    *(used(name, f"beam; without second moments and torsion constant a link; no pin flags 2 and 3{AS_BARS}",
           f"EID PID GA GB X1 X2 X3 OFFT PA PB W1A W2A W3A W1B W2B W3B{more}",
           refused={more.strip(): WARPING} if more else {})
      for name, more in (("CBAR", ""), ("CBEAM", " SA SB"))),
    used("BAROR", "default property and axis of CBAR", "- PID - - X1 X2 X3 OFFT"),
    used("BEAMOR", "default property and axis of CBEAM", "- PID - - X1 X2 X3 OFFT"),
    used("PROD", "area; torsion between ends of beams", "PID MID A J C NSM", idle={"C": SECTION_POINTS}),
    used("PTUBE", "area", "PID MID OD T NSM OD2"),
    used("PBAR", "section", "PID MID A I1 I2 J NSM - C1 C2 D1 D2 E1 E2 F1 F2 K1 K2 I12",
         idle={"C1 C2 D1 D2 E1 E2 F1 F2": SECTION_POINTS}),
    used("PBARL", "section", "PID MID GROUP TYPE - - - - DIMi NSM", own=True),
    used("PBEAM", "section; a taper is divided into 8 uniform beams; N1, N2 are refused",
         "PID MID A I1 I2 I12 J NSM C1 C2 D1 D2 E1 E2 F1 F2 SO X/XB K1 K2 S1 S2 "
         "NSI(A) NSI(B) CW(A) CW(B) M1(A) M2(A) M1(B) M2(B) N1(A) N2(A) N1(B) N2(B)",
         idle={"S1 S2 CW(A) CW(B)": "they act in warping and in the shear of tapers",
               "NSI(A) NSI(B) M1(A) M2(A) M1(B) M2(B)": TURNS, "C1 C2 D1 D2 E1 E2 F1 F2 SO": SECTION_POINTS}, own=True),
    used("PBEAML", "section; a taper is divided into 8 uniform beams", "PID MID GROUP TYPE - - - - DIMi NSM SO X/XB",
         idle={"SO": SECTION_POINTS}, own=True),
    used("MAT1", "material", "MID E G NU RHO A TREF GE ST SC SS MCSID",
         idle={"GE": MATERIAL_DAMPING, "ST SC SS": "stress limits: only margins are made of them",
               "MCSID": "direction of stress output"}),
    # Springs and masses.
    used("CELAS1", CELAS, "EID PID G1 C1 G2 C2"),
    used("CELAS2", CELAS, "EID K G1 C1 G2 C2 GE S",
         idle={"GE": MATERIAL_DAMPING, "S": OUTPUT}),
    used("PELAS", "stiffness of springs", "PID1 K1 GE1 S1 PID2 K2 GE2 S2",
         idle={"GE1 GE2": MATERIAL_DAMPING, "S1 S2": OUTPUT}),
    used("CBUSH", "springs along its line or to the ground; where beams end, springs between rigid arms, without OCID",
         "EID PID GA GB GO/X1 X2 X3 CID S OCID S1 S2 S3", idle={"S1 S2 S3": "they belong to OCID"}),
    used("PBUSH", "stiffness of springs", "PID K Ki B GE RCV M", idle={"B GE": MATERIAL_DAMPING, "RCV": OUTPUT},
         refused={"M": "mass of a spring"}, own=True),
    used("CONM1", "mass of a node", "EID G CID M11 M21 M22 M31 M32 M33 M41 M42 M43 M44 M51 M52 M53 M54 M55 M61 M62 M63 "
         "M64 M65 M66", idle={"M44 M54 M55 M64 M65 M66": TURNS},
         refused={"M21 M31 M32 M41 M42 M43 M51 M52 M53 M61 M62 M63": "it couples directions"}),
    used("CONM2", "mass of a node; beside it, its weight is a moment where beams end",
         "EID G CID M X1 X2 X3 - I11 I21 I22 I31 I32 I33",
         idle={"I11 I21 I22 I31 I32 I33": "inertia of rotations does not act in statics"}),
    used("CMASS1", "mass of a node, where it is one in all directions that are not held", "EID PID G1 C1 G2 C2"),
    used("CMASS2", "mass of a node, where it is one in all directions that are not held", "EID M G1 C1 G2 C2"),
    used("PMASS", "masses of CMASS1", "PID1 M1 PID2 M2 PID3 M3 PID4 M4"),
    # Supports, loads and temperatures.
    used("SPC", "directions without motion", "SID G1 C1 D1 G2 C2 D2", sets="spc"),
    used("SPC1", "directions without motion", "SID C Gi", repeats=1, sets="spc"),
    # Rigid bodies and equations.
    used("RBAR", BODY, "EID GA GB CNA CNB CMA CMB ALPHA", refused={"ALPHA": EXPANDS}),
    used("RBAR1", BODY, "EID GA GB CB ALPHA", refused={"ALPHA": EXPANDS}),
    used("RBE2", BODY, "EID GN CM GMi ALPHA", refused={"ALPHA": EXPANDS}, own=True),
    used("RBE3", "`[[mean]]`; constraints where some Ci are not 123; nothing where nothing acts on its node REFGRID",
         "EID - REFGRID REFC WTi Ci Gi,j UM GMi CMi ALPHA", own=True,
         idle={"UM GMi CMi": "which displacements are dependent: the solver chooses"},
         refused={"ALPHA": "thermal expansion of a mean, where something acts on REFGRID"}),
    used("RROD", "constraint along the line of its nodes", "EID GA GB CMA CMB ALPHA",
         idle={"CMA CMB": "which displacement is dependent: the solver chooses"}, refused={"ALPHA": EXPANDS}),
    used("MPC", "support, one node of two at one place, loads of a node at which no bar ends, or constraint; "
         "components 4 to 6 where beams end",
         "SID G1 C1 A1 G2 C2 A2 - - G3 C3 A3 G4 C4 A4 - -", repeats=8, sets="mpc"),
    used("SPCADD", "several sets of supports", "SID Si", repeats=1),
    used("MPCADD", "several sets of equations", "SID Si", repeats=1),
    *(used(name, "several sets of loads with factors", "SID S Si Li", repeats=2) for name in ("LOAD", "LOADADD")),
    used("FORCE", "dead load", "SID G CID F N1 N2 N3", sets="load"),
    used("FORCE1", "dead load", "SID G F G1 G2", sets="load"),
    used("FORCE2", "dead load", "SID G F G1 G2 G3 G4", sets="load"),
    *(used(name, TWIST, f"SID G {more}", sets="load") for name, more in (
        ("MOMENT", "CID M N1 N2 N3"), ("MOMENT1", "M G1 G2"), ("MOMENT2", "M G1 G2 G3 G4"))),
    used("DEFORM", "stress-free length of a bar", "SID EID1 D1 EID2 D2 EID3 D3", sets="deform"),
    used("PLOAD1", "loads of both ends, with which nodes move as under the load; section forces of its beam exclude "
         "those of the clamped beam; bars: only along them", "SID EID TYPE SCALE X1 P1 X2 P2", sets="load"),
    used("TEMPRB", "temperatures and gradients of beams; gradients must be equal at both ends",
         "SID EID1 T(A) T(B) TP1(A) TP1(B) TP2(A) TP2(B) TC(A) TD(A) TE(A) TF(A) TC(B) TD(B) TE(B) TF(B) EIDi",
         idle={"TC(A) TD(A) TE(A) TF(A) TC(B) TD(B) TE(B) TF(B)": SECTION_POINTS}, repeats=1, sets="temperature"),
    used("GRAV", "gravity", "SID CID A N1 N2 N3 MB", idle={"MB": "superelement: the structure is taken as one"},
         sets="load"),
    used("TEMP", "temperature of links", "SID G1 T1 G2 T2 G3 T3", sets="temperature"),
    used("TEMPD", "temperature of links", "SID1 T1 SID2 T2 SID3 T3 SID4 T4"),
    used("PARAM", "WTMASS: factor of all masses; AUTOSPC", "N V1 V2", own=True),
    # Not supported.
    refused("RBE1 RBE2GS RJOINT RTRPLT RTRPLT1 RSPLINE RSSCON CRIGD1 CRIGD2 CRIGD3 CRIGDR CRBAR CRBE1 CRBE2 CRBE3 "
            "CRROD CRTRPLT", RIGID),
    refused("SUPORT", SUPORTED), refused("SUPORT1", SUPORTED, sets="suport"),
    refused("SPCD", "displacement given in a static solution; in SOL 108 to 112 it is left out", sets="load"),
    refused("PLOAD PLOAD2 PLOAD3 PLOAD4 PLOADX PLOADX1 PLOADB3", "pressure on an element", sets="load"),
    refused("RFORCE RFORCE1 ACCEL ACCEL1", "loads of a field of accelerations", sets="load"),
    refused("SLOAD", "load on a scalar point", sets="load"),
    refused("TEMPP1 TEMPP2 TEMPP3 TEMPB3 TEMPF TEMPN1 TEMPBC TEMPAX", "temperatures of elements",
            sets="temperature"),
    refused("MATT1 MATT2 MATT3 MATT5 MATT8 MATT9", "properties that depend on temperature"),
    refused("MATS1 CREEP", "material that is not linear"),
    refused("CELAS3 CELAS4 CMASS3 CMASS4", "it joins scalar points"),
    refused("CBUSH1D CBUSH2D CGAP CWELD CFAST CSEAM CINTC GENEL", "element that is no straight bar of two nodes"),
    refused("CBEND CBEAM3 CELBOW", "curved beam"),
    refused("PBCOMP PBRSECT PBMSECT", "section whose area is not known from one number"),
    refused("CSHEAR CQUAD CQUAD4 CQUAD8 CQUADR CQUADX CQUADX4 CQUADX8 CTRIA3 CTRIA6 CTRIAR CTRIAX CTRIAX6 CTRAX3 "
            "CTRAX6 CPLSTN3 CPLSTN4 CPLSTS3 CPLSTS4 CQUAD1 CQUAD2 CTRIA1 CTRIA2 CTRMEM CQDMEM CQDMEM1 CQDMEM2 CTRPLT "
            "CTRPLT1 CQDPLT CTRBSC CTWIST CTRIM6 CTRSHL CIS2D8 CCONEAX CTRIARG CTRAPRG CTORDRG CTRIAAX CTRAPAX", SHELL),
    refused("CHEXA CPENTA CPYRAM CTETRA CHEXA1 CHEXA2 CWEDGE CIHEX1 CIHEX2 CIHEX3", SOLID),
    refused("CAABSF CHACAB CHACBR ACMODL", "acoustics"),
    refused("NSM NSM1 NSML NSML1 NSMADD", "non-structural mass", sets="nsm"),
    refused("BCONP BCTABLE BCTSET BSURFS BGSET BLSEG", "contact"),
    # No influence.
    idle("ENDDATA ECHOON ECHOOFF CBARAO PLOTEL PLOTEL3 PLOTEL4 SET1 SET2 SET3 GRIDG", OUTPUT),
    idle("PSHELL PCOMP PCOMPG PSHEAR PSOLID PLSOLID PBEND PBEAM3 PGAP PBUSH1D PBUSHT PELAST PQUAD PPLANE PLPLANE "
         "PAABSF PACABS MAT2 MAT3 MAT4 MAT5 MAT8 MAT9 MAT10 MAT11 MATHP MATHE MATT4 TABLEM1 TABLEM2 TABLEM3 TABLEM4 "
         "TABLES1 SPOINT EPOINT PSEAM PWELD PFAST PQUAD1 PQUAD2 PTRIA1 PTRIA2 PTRMEM PQDMEM PQDMEM1 PQDMEM2 PTRPLT "
         "PTRPLT1 PQDPLT PTRBSC PTWIST PTRIM6 PTRSHL PIS2D8 PIHEX PCONEAX PTRIAAX PTRAPAX PTORDRG PELBOW", THROUGH),
    idle("CDAMP1 CDAMP2 CDAMP3 CDAMP4 CDAMP5 PDAMP PDAMPT CVISC PVISC", MATERIAL_DAMPING),
    idle("EIGB EIGC EIGP EIGR EIGRL FREQ FREQ1 FREQ2 FREQ3 FREQ4 FREQ5 TSTEP TSTEPNL NLPARM NLPCI NLSTEP DLOAD RLOAD1 "
         "RLOAD2 TLOAD1 TLOAD2 DAREA DELAY DPHASE LSEQ LOADCYN ACSRCE RANDPS RANDT1 TABLED1 TABLED2 TABLED3 TABLED4 "
         "TABDMP1 TABRND1 TABRNDG TIC TF NOLIN1 NOLIN2 NOLIN3 NOLIN4 ROTORG ROTORD UNBALNC RGYRO NLRGAP SPCR", DYNAMIC),
    idle("DESVAR DVPREL1 DVPREL2 DVMREL1 DVMREL2 DVCREL1 DVCREL2 DVGRID DVSHAP DRESP1 DRESP2 DRESP3 DCONSTR DCONADD "
         "DOPTPRM DSCREEN DEQATN DTABLE DDVAL DLINK DVBSHAP DRESP1L MODTRAK BEADVAR TOPVAR DIVERG", DESIGN),
    idle("AERO AEROS AEROZ AEFACT AELIST AELINK AEPARM AESTAT AESURF AESURFS CAERO1 CAERO2 CAERO3 CAERO4 CAERO5 CAERO7 "
         "PAERO1 PAERO2 PAERO3 PAERO4 PAERO5 PAFOIL7 SPLINE1 SPLINE2 SPLINE3 SPLINE4 SPLINE5 PANLST1 PANLST2 PANLST3 "
         "FLFACT FLUTTER GUST MKAERO1 MKAERO2 MKAEROZ TRIM TRIMFLT TRIMVAR TRIMFNC LOADMOD CSSCHD MONPNT1 MONPNT3 "
         "MLOADS EXTINP EXTOUT FLUTTF FIXHATM ACOORD ATTACH CELLBOX CELLWNG INPCFD BODY7 SEGMESH DMIS", AERO),
    idle("CHBDY CHBDYE CHBDYG CHBDYP PHBDY PCONV PCONVM CONV CONVM RADM RADMT RADBC RADLST RADCAV RADSET RADMTX VIEW "
         "VIEW3D QBDY1 QBDY2 QBDY3 QHBDY QVECT QVOL", HEAT),
    idle("ASET ASET1 BSET BSET1 CSET CSET1 OMIT OMIT1 QSET QSET1 USET USET1 SEQSET SEQSET1 SEBSET SEBSET1 SECSET "
         "SECSET1 SESET CSUPEXT SEELT RELEASE DYNRED CYJOIN", EXACT),
    idle("DMI DMIG DMIJ DMIJI DMIK DTI", "matrix: acts through K2GG, M2GG or P2G, which are not supported"),
    idle("CLOAD", "acts through the command CLOAD, which is not supported"),
    idle("MDLPRM ITER INTS FLOATS SEQGP DEBUG CNGRNT", "how a program solves"),
)

# Names of PARAM. The influence of other names is unknown.
PARAMS: dict[str, Card] = table(
    used("WTMASS", "factor of all masses"),
    used("AUTOSPC", "whether directions of nodes without stiffness are held; YES if not given"),
    refused("INREL", "inertia relief"),
    refused("HEATSTAT", "temperatures that another subcase computes"),
    refused("CK1 CK2 CK3 CM1 CM2 CP1 CP2", "factor of matrices"),
    refused("PREMASS SUPAERO", "changes of the model"),
    used("ART_MASS", "of rotations: nothing; a mass that is added at every node is refused"),
    refused("ART_KED", "stiffness that is added at every node"),
    refused("CTYPE NSEGS NLOAD KINDEX KMIN KMAX", "cyclic symmetry: the deck is one sector of a structure"),
    idle("POST PRTMAXIM GRDPNT PRGPST PRTRESLT USETPRT USETSEL AUTOSPCR EPZERO MAXRATIO BAILOUT TINY NOFISR OGEOM "
         "OUGCORD OUNIT1 OUNIT2 PATVER PRINT OMID OLDSEQ NEWSEQ SNORM SEP1XOVR K6ROT LGDISP LMODES G W3 W4 GFL W3FL "
         "W4FL COUPMASS RESVEC RESVINER DDRMM HFREQ LFREQ LMODESFL KDAMP VREF MACH Q AUNITS FACTOR NASPRT CURVPLOT "
         "DBDICT DBALL DBEXT EXTOUT EXTDR MODACC NOCOMPS NOELOF NOELOP NOGPF NONLMETH NLAYERS NINTPTS NT RSPLICE "
         "SIGMA STRESS TABS SRCOMPS XYUNIT OPTEXIT DESPCH NASM DSZERO CDPRT IUNIT OPGEOM OPTION OSETELE PDRMSG PROUT "
         "PLTMSG S1 SESEF SEMAP START TABID ULTIMA VUGRAPH ASING BUCKLE TESTNEG MINRATIO EST ECHOON CHECKOUT CHKOUT "
         "CONFAC RMSINT DYNSPCF INRLM PARTN FIXEDB GEOMU GPECT IRES LOADU MESH NDAMP NUMOUT OG BIGER BIGER1 "
         "BIGER2 ADPCON ERROR CASPIV CASEM SKPAMP UNSYMF VMOPT WRBEAMB XFLAG ALTRED ALTSHAPE AESMETH AESRNDM AESTOL "
         "AUTOQSET RMXPANEL F56 RESLTOPT SOLADJC SDRPOPT SDRDENS SERST SECOMB SUBCASID MPCX EXTUNIT EXTDROUT OELMSET "
         "OGRDSET ISAVE NEWSET HDF5 CONM2 PEDGE MNLEMPRT FLUIDMP STRUCTMP FREQDEP OMACHPR GYROAVG WR3 WR4 ROTCSV "
         "ROTGPF ENFMETH ENFMOTN NQMAX CYCIO CYCSEQ OIBULK POSTEXT UNITSYS DBCDIAG DMIGNRG LSTRN COMPARE PNCHDB EPSHT "
         "MAXIT SUPER TINY2 OMSGLVL BETAD EPSIO GRDEQ SESDAMP CDIF PRTGPL PRTEQXIN PRTBGPDT",
         "output, damping, or how a program solves"),
    idle("ARP_TOL CBMIN3 CBMIN4 CBMIN4T CHKGRDS CRS_CCS CUSERIN DARPACK DELBAN EIGESTL EIGNORM2 ELFORCEN EPSERR EPSIL "
         "EQCHECK GRIDSEQ LANCMETH MXITERI PRTBASIC PRTCGLTM PRTCORD PRTCSTM PRTDLR PRTDOF PRTFOR PRTGMN PRTGOA "
         "PRTGPDT PRTHMN PRTIFLTM PRTKXX PRTMASS PRTMGG PRTMXX PRTPG PRTPHIXA PRTPHIZL PRTQSYS PRTRMG PRTSCP PRTSTIFD "
         "PRTSTIFF PRTTSET PRTUO0 PRTYS RCONDK SOLLIB SORT_MAX SPARSTOR", "output of MYSTRAN, or how it solves"),
)

# Commands of the case control. Other commands select nothing that acts on a truss in statics.
CONTROL: dict[str, Card] = table(
    used("AUTOSPC", "whether directions of nodes without stiffness are held"),
    used("SUBCASE", "the first one, or that of --step"),
    used("SPC", "set of supports"), used("LOAD", "set of loads"), used("MPC", "set of MPC"),
    used("TEMPERATURE", "LOAD, BOTH: temperatures; INITIAL: those free of stress of materials without TREF"),
    used("DEFORM", "set of DEFORM"), used("NSM", "set of NSM, which is not supported"),
    used("SUPORT1", "set of SUPORT1, which is not supported in statics"),
    refused("K2GG M2GG P2G B2GG A2GG", "matrices that are added to the structure"),
    refused("ANALYSIS", "of HEAT: its supports are temperatures"),
    refused("TRIM", "loads of aerodynamics"),
    refused("SUBCOM SYM SYMCOM REPCASE", "it combines the results of other subcases"),
    refused("CLOAD", "loads of another run"), refused("BCONTACT BCSET", "contact"), refused("BOLTLD", "bolts"),
)
